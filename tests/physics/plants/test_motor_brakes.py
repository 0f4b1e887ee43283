"""Brakes of flexible joints' motors: the tick in which each closes, on both sides of it and after a reset."""

import numpy as np
import pytest

from runner.papers.studies.thesis_beyond.cantilever import clamped_arm
from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import FlexibleJoints
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel

TICK = 2e-3  # s, of two steps
SPIN = 0.7  # rad/s


def plant(braked):
    """Return an arm of one joint, whose spring is so soft that its motor turns at a constant speed."""
    one = np.ones(1)
    return FlexibleJoints(
        clamped_arm(1.0, 1.0), Flexibility(1e-9 * one, one, 0.0 * one, braked * one, 0.0 * one), TICK / 2, 2
    )


def speeds(arm, ticks):
    """Return the speed of the motor after each tick, from the start of a run."""
    arm.reset(np.zeros(1), SPIN * np.ones(1))
    found = []
    for _ in range(ticks):
        arm.advance(np.zeros(1))
        found.append(float(arm.dtheta[0]))
    return found


@pytest.mark.parametrize(
    ("braked", "turns"),
    [(0.0, 0), (0.5, 1), (1.0, 1), (2.0, 2), (2.01, 3), (3.0, 3), (np.inf, 6)],
)
def test_a_motor_stands_still_from_the_first_tick_that_begins_with_its_brake_closed(braked, turns):
    arm = plant(braked * TICK)
    expected = [SPIN] * turns + [0.0] * (6 - turns)
    assert speeds(arm, 6) == pytest.approx(expected, abs=1e-9)
    assert speeds(arm, 6) == pytest.approx(expected, abs=1e-9)  # after a reset the time begins again


def test_a_closed_brake_holds_the_motor_against_any_torque():
    arm = plant(0.0)
    arm.reset(np.zeros(1), np.zeros(1))
    for _ in range(3):
        arm.advance(1e6 * np.ones(1))
    assert (float(arm.theta[0]), float(arm.dtheta[0])) == (0.0, 0.0)


def test_the_brake_of_one_joint_leaves_the_others_alone():
    model = RobotModel(read_urdf(find_urdf("macro.urdf"), {}), "tip")
    model.pin_model.gravity.linear = np.zeros(3)
    soft, zero = 1e-9 * np.ones(3), np.zeros(3)
    arm = FlexibleJoints(model, Flexibility(soft, np.ones(3), zero, np.array([np.inf, 0.0, 2 * TICK]), zero), TICK, 1)
    arm.reset(np.zeros(3), SPIN * np.ones(3))
    found = []
    for _ in range(3):
        arm.advance(np.zeros(3))
        found.append(arm.dtheta.copy())
    np.testing.assert_allclose(found, SPIN * np.array([[1, 0, 1], [1, 0, 1], [1, 0, 0]]), atol=1e-6)
