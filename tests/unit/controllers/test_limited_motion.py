"""The reference of limited motion; its pose tracking is in tests/physics/controllers/test_admittance.py."""

import numpy as np

from runner.controllers.kinematic.limited_motion import Approach

PERIOD, SPEED = 0.01, 0.5


def test_a_slow_motion_is_followed_as_it_is():
    approach = Approach(PERIOD, SPEED)
    approach.reset(np.zeros(3))
    for desired in np.linspace([0.0, 0.0, 0.0], [0.1, 0.0, 0.0], 50):
        np.testing.assert_array_equal(approach.follow(desired), desired)


def test_a_jump_is_made_good_at_the_largest_speed_from_rest_to_rest():
    approach, goal = Approach(PERIOD, SPEED), np.array([0.3, 0.0, 0.4])
    approach.reset(np.zeros(3))
    way = np.array([np.zeros(3), *(approach.follow(goal).copy() for _ in range(250))])
    speeds = np.linalg.norm(np.diff(way, axis=0), axis=1) / PERIOD
    assert 0.99 * SPEED < speeds.max() <= SPEED
    assert speeds[0] < 1e-3
    np.testing.assert_allclose(way[188:], np.broadcast_to(goal, (63, 3)), atol=1e-12)  # 1.875 * 0.5 m / SPEED
    np.testing.assert_allclose(np.cross(way, goal), 0.0, atol=1e-15)  # straight
