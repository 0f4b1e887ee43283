"""Line in both directions: extent, speed and acceleration against the harmonic motion."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from runner.base.errors import ConfigError
from runner.trajectories.line import LineConfig, build
from runner.trajectories.motion import PathMotion, Segment

points = st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3).map(np.array)
A, B = np.array([0.643, -0.2, 0.1508]), np.array([0.643, 0.2, 0.1508])  # of the xArm7 report


def test_the_report_s_line_moves_along_y_alone_by_40_cm():
    motion = PathMotion(Segment(A, B), 10.0, "cosine").sample(np.linspace(0.0, 10.0, 1_001))
    np.testing.assert_array_equal(motion[:, 0, [0, 2]], np.tile([0.643, 0.1508], (1_001, 1)))
    np.testing.assert_array_equal(motion[:, 1:, [0, 2]], 0.0)
    assert np.ptp(motion[:, 0, 1]) == pytest.approx(0.4, abs=1e-15)


@given(points, points, st.floats(0.1, 10.0))
def test_it_is_at_rest_in_a_and_in_b_and_halfway_between_at_a_quarter(start, end, T):
    motion = PathMotion(Segment(start, end), T, "cosine").sample(T * np.array([0.0, 0.25, 0.5, 0.75, 1.0]))
    np.testing.assert_allclose(motion[:, 0], [start, (start + end) / 2, end, (start + end) / 2, start], atol=1e-14)
    np.testing.assert_allclose(motion[[0, 2, 4], 1], 0.0, atol=1e-14 / T)


@given(points, points, st.floats(0.1, 10.0))
def test_peak_speed_and_acceleration(start, end, T):
    D = np.linalg.norm(end - start)
    assume(D > 1e-3)
    motion = PathMotion(Segment(start, end), T, "cosine").sample(np.linspace(0.0, T, 4_001))
    speed, acceleration = (np.linalg.norm(motion[:, k], axis=1) for k in (1, 2))
    assert speed.max() == pytest.approx(np.pi * D / T, rel=1e-12)
    assert speed.argmax() in (1_000, 3_000)
    assert acceleration.max() == pytest.approx(2.0 * np.pi**2 * D / T**2, rel=1e-12)
    assert acceleration[0] == pytest.approx(acceleration.max(), rel=1e-12)


@given(points, points)
def test_it_swings_about_its_middle_as_on_a_spring(start, end):
    T = 2.0
    motion = PathMotion(Segment(start, end), T, "cosine").sample(np.linspace(0.0, 3.0 * T, 61))
    np.testing.assert_allclose(motion[:, 2], -((2.0 * np.pi / T) ** 2) * (motion[:, 0] - (start + end) / 2), atol=1e-12)


def test_its_speed_is_a_sine_whose_cosine_is_the_place():
    y = PathMotion(Segment(A, B), 10.0, "cosine").sample(np.linspace(0.0, 5.0, 101))[:, :2, 1]
    np.testing.assert_allclose(y[:, 1], 0.2 * 2.0 * np.pi / 10.0 * np.sin(np.arccos(-y[:, 0] / 0.2)), atol=1e-9)


def test_the_distance_beyond_its_ends_goes_to_the_end():
    line = PathMotion(Segment(np.zeros(3), np.array([2.0, 0.0, 0.0])), 3.0, "cosine")
    found = line.distance_to_path(np.array([[0.5, 3.0, 4.0], [-3.0, 4.0, 0.0], [5.0, 0.0, 4.0]]))
    np.testing.assert_allclose(found, [5.0, 5.0, 5.0])


def test_a_line_to_its_start_is_refused():
    with pytest.raises(ConfigError, match=r"trajectory.goal: .* is the start, and a line leads elsewhere"):
        build(LineConfig(kind="line", start=None, goal=A.tolist(), duration=1.0), A)
