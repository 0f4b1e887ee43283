"""Warnings about unusual configs that can be run, printed with the run."""

import pytest
from support import strangers
from support.strangers import Y, Z

ARM = strangers.chain("arm", [("revolute", Z), ("revolute", Y), ("revolute", Y)], tip=(0.1, 0.0, 0.25))
YAML = """# @package _global_
# An arm
defaults: [override /controller: computed_torque, override /trajectory: goal]
robot: {name: arm, urdf: arm.urdf, tip: tip, home: [0.2, 0.4, 0.5], goal: [0.3, 0.1, 0.5]}
"""


@pytest.fixture
def told(cli, tmp_path):
    """Messages on standard error of a run of an arm."""

    def run(urdf, *overrides):
        own = tmp_path / "own"
        (own / "robot").mkdir(parents=True, exist_ok=True)
        (own / "robot" / "arm.yaml").write_text(YAML)
        (own / "arm.urdf").write_text(urdf)
        ending = cli("--config-dir", own, "robot=arm", "duration=0.05", *overrides)
        assert ending.code == 0
        return "".join(line for line in ending.err.splitlines(keepends=True) if line.startswith("runner: warning: "))

    return run


def test_a_joint_that_nothing_can_push_is_named(told):
    one = ARM.replace('effort="2000"', 'effort="0"', 1)
    warning = "runner: warning: robot.urdf: joint 'q1' has the effort limit 0, and nothing pushes it"
    assert told(one) == f"{warning}; is its limit missing?\n"
    assert told(ARM.replace('effort="2000"', 'effort="0"')).count("nothing pushes it") == 3


def test_a_limit_that_has_no_effect_is_not(told):
    assert told(ARM.replace('velocity="20"', 'velocity="0"')) == ""
