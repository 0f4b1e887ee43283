"""Caveat of gains that are too high for the control period, on both sides of the bound."""

import pytest
from support.caveat_runs import found

LINE = ("robot=xarm7", "trajectory=joint_quintic", "trajectory.goal_configuration=[0.4,-0.3,0.3,0.4,-0.3,0.3,0.4]",
        "controller.period=0.001", "controller.natural_frequency=30")  # fmt: skip


def test_light_joints_that_move_others_are_told_the_bound(checked_config):
    """Without rotors joint PD is unstable along this motion, and chatters."""
    told = found(checked_config(*LINE, "controller=joint_pd"))["unstable_gains"]
    assert told.value == pytest.approx(5.64, abs=0.01)
    assert "or controller.period is at least 5.64 times too large" in told.text
    assert "robot.armature" in told.text
    assert "lambda_max(M^-1 diag M) is 188" in told.text


def test_a_law_of_the_whole_mass_matrix_is_told_its_own(checked_config):
    told = found(checked_config(*LINE, "controller=computed_torque", "controller.natural_frequency=1200"))
    assert told["unstable_gains"].value == pytest.approx(1.2)
    assert "armature" not in told["unstable_gains"].text


QUIET = [
    ("controller=computed_torque",),
    ("controller=joint_pd", "robot.armature=assumed"),
    ("controller=joint_pd", "caveats.unstable_gains.share=6"),
]


@pytest.mark.parametrize("more", QUIET)
def test_other_laws_have_no_caveat_of_gains(checked_config, more):
    assert "unstable_gains" not in found(checked_config(*LINE, *more))
