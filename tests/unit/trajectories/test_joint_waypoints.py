"""Joint way-points: each is passed at its time; with one it is the quintic; errors name their key."""

import numpy as np
import pytest
from support.arms import checked

from runner.base.errors import ConfigError
from runner.trajectories.joint_waypoints import JointWaypointsConfig, joint_motion
from runner.trajectories.motion import quintic_motion

ROBOT = checked("robot=macro").arm
FIRST, SECOND = [0.2, 0.4, -0.6], [0.5, 0.1, -0.9]


def config(configurations, time_shares=None):
    return JointWaypointsConfig(
        kind="joint_waypoints",
        start_configuration=0.0,
        configurations=configurations,
        time_shares=time_shares,
        duration=2.0,
    )


def test_every_configuration_is_passed_at_its_time():
    motion = joint_motion(config([FIRST, SECOND], [0.25, 1.0]), ROBOT)
    found = motion.sample(np.array([0.0, 0.5, 2.0, 3.0]))
    np.testing.assert_allclose(found[:, 0], [np.zeros(3), FIRST, SECOND, SECOND], atol=1e-12)
    np.testing.assert_allclose(found[[0, 2, 3], 1:], 0.0, atol=1e-9)


def test_times_without_shares_are_proportional_to_the_distance():
    motion = joint_motion(config([[0.1] * 3, [0.4] * 3]), ROBOT)
    np.testing.assert_allclose(motion.sample(np.array([0.5]))[0, 0], 0.1, rtol=1e-9)


def test_with_one_configuration_it_is_the_quintic():
    times, quintic = np.linspace(0.0, 2.0, 9), quintic_motion(np.zeros(3), np.array(FIRST), 2.0)
    found = joint_motion(config([FIRST]), ROBOT).sample(times)
    np.testing.assert_allclose(found, quintic.sample(times), atol=1e-9)


def test_two_equal_configurations_in_succession_are_an_error():
    with pytest.raises(
        ConfigError, match=r"trajectory\.configurations\.1: is the same as trajectory\.configurations\.0"
    ):
        joint_motion(config([FIRST, FIRST, SECOND]), ROBOT)
