"""Torque limits that fall with the speed: both sides of each bound, and the limit that applied to a torque."""

import numpy as np
import pytest

from runner.plants.motor_limits import TorqueLimits

LIMITS = TorqueLimits(np.array([10.0, 4.0]), np.array([5.0, np.inf]))


@pytest.mark.parametrize(
    ("speed", "lowest", "highest"),
    [
        (0.0, -10.0, 10.0),
        (2.0, -10.0, 6.0),
        (5.0, -10.0, 0.0),
        (7.0, -10.0, 0.0),
        (-2.0, -6.0, 10.0),
        (-9.0, 0.0, 10.0),
    ],
)
def test_a_driving_motor_loses_torque_with_speed_and_a_braking_one_does_not(speed, lowest, highest):
    assert LIMITS.depend_on_speed
    low, high = LIMITS.bounds(np.array([speed, speed]))
    assert (low[0], high[0]) == (lowest, highest)
    assert (low[1], high[1]) == (-4.0, 4.0)


def test_constant_limits_are_the_same_at_every_speed():
    constant = TorqueLimits.constant(LIMITS.max)
    assert not constant.depend_on_speed
    assert constant.joints_with_speed == []
    assert constant.bounds(np.array([9.0, 9.0]))[1] is constant.max
    assert constant.applied(np.zeros((3, 2)), np.ones((3, 2))) is constant.max


def test_some_of_the_joints_keep_their_speeds():
    assert LIMITS.joints_with_speed == [0]
    assert LIMITS.of(slice(0, 1)).depend_on_speed
    assert not LIMITS.of(slice(1, 2)).depend_on_speed


def test_the_limit_that_applied_is_that_of_the_direction_of_the_torque():
    dq = np.array([[2.0, 1.0], [-2.0, 1.0], [6.0, 1.0], [6.0, 1.0]])
    tau = np.array([[1.0, 1.0], [1.0, -1.0], [0.0, 4.0], [-3.0, 0.0]])
    np.testing.assert_array_equal(LIMITS.applied(tau, dq), [[6.0, 4.0], [10.0, 4.0], [0.0, 4.0], [10.0, 4.0]])


def test_a_held_torque_keeps_the_limit_of_the_tick_that_commanded_it():
    dq = np.zeros((6, 2))
    dq[:, 0] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    found = LIMITS.applied(np.ones((6, 2)), dq, [(slice(0, 1), 3), (slice(1, 2), 1)])
    np.testing.assert_allclose(found[:, 0], [10.0, 10.0, 10.0, 4.0, 4.0, 4.0])
    np.testing.assert_allclose(LIMITS.applied(np.ones((2, 6, 2)), np.array([dq, dq]), [(slice(0, 2), 3)])[1], found)
