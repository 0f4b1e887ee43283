"""Caveat of parts of an MJCF that are left out of the motion."""

from textwrap import dedent

import pytest
from support.caveat_runs import found
from support.mjcf_arms import CHAIN, written

from runner.config.compose import compose
from runner.config.validation import validate

ROBOT = """\
# @package _global_
# An arm as MJCF
defaults: [{override /controller: operational_space}, {override /trajectory: quintic}]
robot: {name: elbow, mjcf: arm.xml, tip: tcp, home: [0.0, 0.5, 1.0], goal: [0.4, 0.2, 0.2]}
"""


@pytest.fixture
def caveats_of(tmp_path):
    """What the rules say of a run of an MJCF's text."""

    def run(text, *overrides):
        written(tmp_path, text)
        written(tmp_path, dedent(ROBOT), "robot/elbow.yaml")
        composed = compose(["robot=elbow", "duration=0.1", "trajectory.duration=0.1", *overrides], [tmp_path])
        return found(validate(composed.resolved, [tmp_path]))

    return run


def test_a_run_says_what_its_mjcf_holds_and_it_has_not(caveats_of):
    damped = CHAIN.replace("<joint ", '<joint damping="2" armature="0.1" ', 1)
    caveat = caveats_of(damped)["mjcf"]
    assert caveat.value == 2.0
    assert caveat.text == (
        "not taken from arm.xml: damping (plant.friction.viscous): 2 (q1, q2, q3); "
        "armature (robot.armature): 0.1 (q1, q2, q3)"
    )
    assert "mjcf" not in caveats_of(damped, "caveats.mjcf.left_out=2")


def test_an_mjcf_of_bodies_and_joints_alone_has_no_caveat(caveats_of):
    assert "mjcf" not in caveats_of(CHAIN)
