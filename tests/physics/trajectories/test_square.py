"""Square: rests at its corners, speed of its edges and distance."""

import numpy as np
import pytest

from runner.trajectories.square import SquareConfig, build

START = np.array([0.3, -0.2, 0.4])


@pytest.fixture
def square():
    config = SquareConfig(
        kind="square",
        start=None,
        half_edge=0.1,
        normal=[0.0, 0.0, 2.0],
        edge_direction=[0.0, 3.0, 0.0],
        duration=8.0,
    )
    return build(config, START)


def test_it_rests_at_each_corner_counter_clockwise(square):
    motion = square.sample(np.array([0.0, 2.0, 4.0, 6.0, 8.0]))
    corners = [[0.0, 0.0, 0.0], [0.0, 0.2, 0.0], [-0.2, 0.2, 0.0], [-0.2, 0.0, 0.0], [0.0, 0.0, 0.0]]
    np.testing.assert_allclose(motion[:, 0] - START, corners, atol=1e-15)
    np.testing.assert_allclose(motion[:, 1:], 0.0, atol=1e-15)


def test_it_does_not_cut_its_corners(square):
    path = square.sample(np.linspace(0.0, 8.0, 801))[:, 0] - START
    on_edge = [np.abs(path[:, axis] - value) < 1e-15 for axis, value in ((0, 0.0), (0, -0.2), (1, 0.0), (1, 0.2))]
    assert np.any(on_edge, axis=0).all()


def test_each_edge_has_the_quintic_s_peak_speed(square):
    speed = np.linalg.norm(square.sample(np.array([1.0, 3.0, 5.0, 7.0]))[:, 1], axis=1)
    np.testing.assert_allclose(speed, 1.875 * 0.2 / 2.0, rtol=1e-12)
    assert np.linalg.norm(square.sample(np.linspace(0.0, 8.0, 3_001))[:, 1], axis=1).max() <= 1.875 * 0.1 + 1e-15


def test_the_distance_goes_to_the_nearest_edge(square):
    points = np.array([[-0.1, 0.1, 0.0], [-0.1, 0.1, 0.5], [-0.05, 0.1, 0.0], [0.3, 0.6, 0.0], [-0.1, 0.21, 0.0]])
    expected = [0.1, np.hypot(0.1, 0.5), 0.05, 0.5, 0.01]
    np.testing.assert_allclose(square.distance_to_path(START + points), expected, atol=1e-15)
