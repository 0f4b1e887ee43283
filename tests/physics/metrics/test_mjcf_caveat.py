"""Caveat of what is in a robot's file, MJCF or URDF, and has no part in the run."""

from textwrap import dedent

import pytest
from support.caveat_runs import found
from support.mjcf_arms import CHAIN, written

from runner.config.compose.compose import compose
from runner.config.validation import validate
from runner.robots.mjcf import read_mjcf

ROBOT = """\
# @package _global_
# An arm of one's own
defaults: [{override /controller: operational_space}, {override /trajectory: quintic}]
robot: {name: elbow, FORMAT: FILE, tip: tcp, home: [0.0, 0.5, 1.0], goal: [0.4, 0.2, 0.2]}
"""
HELD = CHAIN.replace('name="q1"', 'name="q1" damping="2" armature="0.1"').replace(
    'name="q3"', 'name="q3" damping="3" frictionloss="0.5"'
)
MOON = CHAIN.replace("<default>", '<option gravity="0 0 -1.62" density="1.2"/><default>')


@pytest.fixture(params=["mjcf", "urdf"])
def told(request, tmp_path):
    """Return the rule's caveat on a run of an MJCF, or of the URDF made from it; None without a caveat."""

    def run(text, *overrides):
        path = written(tmp_path, text)
        file = path.name if request.param == "mjcf" else "arm.urdf"
        if request.param == "urdf":
            written(tmp_path, read_mjcf(path).urdf, file)
        written(tmp_path, dedent(ROBOT).replace("FORMAT", request.param).replace("FILE", file), "robot/elbow.yaml")
        composed = compose(["robot=elbow", "duration=0.1", "trajectory.duration=0.1", *overrides], [tmp_path])
        caveat = found(validate(composed)).get("robot_file")
        return caveat and caveat.text.replace(file, "FILE")

    return run


def test_a_run_says_what_its_file_holds_and_it_has_not(told):
    damping, friction, armature = (
        "damping (robot.friction.viscous): 2 (q1), 3 (q3)",
        "friction (robot.friction.coulomb): 0.5 (q3)",
        "armature (robot.armature): 0.1 (q1)",
    )
    assert told(HELD) == f"not taken from FILE: {damping}; {friction}; {armature}"
    assert told(HELD, "robot.friction.viscous=[2,0,3]", "robot.armature=0.1") == f"not taken from FILE: {friction}"
    given = "damping (robot.friction.viscous): 3 (q3)"
    assert told(HELD, "plant.friction.viscous=[1,0,0]", "plant.friction.coulomb=1", "robot.armature=[1,0,0]") == (
        f"not taken from FILE: {given}"
    )
    assert told(HELD, "caveats.robot_file.left_out=3") is None


def test_it_says_nothing_of_what_the_run_has(told):
    assert told(CHAIN) is None
    assert told(HELD, "robot.friction.viscous=1", "robot.friction.coulomb=1", "robot.armature=1") is None


def test_no_force_moves_joints_that_follow_exactly(told):
    assert told(HELD, "plant=kinematic", "controller=differential_inverse_kinematics") is None


def test_motors_of_flexible_joints_are_their_armature(told):
    given = ("robot.friction.viscous=1", "robot.friction.coulomb=1")
    assert told(HELD, "plant=rk4_flexible", *given) is None


def test_gravity_and_air_are_told_and_gravity_that_is_given_is_not(told):
    air = "density of the air of 1.2 in SI units"
    assert told(MOON) == f"not taken from FILE: gravity of 0, 0, -1.62 m/s^2 (gravity, along -z); {air}"
    assert told(MOON, "gravity=1.62") == f"not taken from FILE: {air}"
