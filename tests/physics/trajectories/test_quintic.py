"""Quintic: end conditions, derivatives and distance along the straight path."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from runner.trajectories.motion import quintic_motion
from runner.trajectories.quintic import QuinticConfig, build

points = st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3).map(np.array)
durations = st.floats(0.1, 10.0)


@given(points, points, durations)
def test_the_six_end_conditions(start, goal, t_f):
    first, last = quintic_motion(start, goal, t_f).sample(np.array([0.0, t_f]))
    np.testing.assert_allclose(first, [start, np.zeros(3), np.zeros(3)], atol=1e-12)
    np.testing.assert_allclose(last, [goal, np.zeros(3), np.zeros(3)], atol=1e-12)


@given(points, points, durations, st.floats(0.01, 0.99))
def test_velocity_and_acceleration_are_the_derivatives(start, goal, t_f, share):
    h = 1e-4 * t_f
    t = share * t_f
    before, here, after = quintic_motion(start, goal, t_f).sample(np.array([t - h, t, t + h]))
    np.testing.assert_allclose((after[0] - before[0]) / (2.0 * h), here[1], atol=1e-6 / t_f)
    np.testing.assert_allclose((after[1] - before[1]) / (2.0 * h), here[2], atol=1e-5 / t_f**2)


@given(points, points, durations)
def test_it_is_a_polynomial_of_fifth_order(start, goal, t_f):
    times = np.linspace(0.0, t_f, 13)
    position = quintic_motion(start, goal, t_f).sample(times)[:, 0]
    fit = np.polynomial.polynomial.polyfit(times / t_f, position, 5)
    np.testing.assert_allclose(np.polynomial.polynomial.polyval(times / t_f, fit).T, position, atol=1e-12)


@given(points, points, durations)
def test_peak_speed_and_acceleration(start, goal, t_f):
    D = np.linalg.norm(goal - start)
    assume(D > 1e-3)
    motion = quintic_motion(start, goal, t_f).sample(np.linspace(0.0, t_f, 4001))
    speed, acceleration = (np.linalg.norm(motion[:, k], axis=1) for k in (1, 2))
    assert speed.max() == pytest.approx(1.875 * D / t_f, rel=1e-9)
    assert speed.argmax() == 2000
    assert acceleration.max() == pytest.approx(10.0 / np.sqrt(3.0) * D / t_f**2, rel=1e-6)
    assert acceleration.max() == pytest.approx(5.7735 * D / t_f**2, rel=1e-5)


@given(points, points, durations)
def test_it_is_symmetric_in_time(start, goal, t_f):
    quintic, times = quintic_motion(start, goal, t_f), np.linspace(0.0, t_f, 21)
    there, back = quintic.sample(times), quintic.sample(t_f - times)
    np.testing.assert_allclose(there[:, 0] + back[:, 0], np.tile(start + goal, (21, 1)), atol=1e-12)
    np.testing.assert_allclose(there[:, 1], back[:, 1], atol=1e-11 / t_f)
    np.testing.assert_allclose(there[:, 2], -back[:, 2], atol=1e-10 / t_f**2)


@given(points, points, durations)
def test_it_runs_along_the_straight_path(start, goal, t_f):
    quintic = quintic_motion(start, goal, t_f)
    path = quintic.sample(np.linspace(0.0, t_f, 21))[:, 0]
    np.testing.assert_allclose(quintic.distance_to_path(path), 0.0, atol=1e-12)
    assert ((np.diff(path, axis=0) @ (goal - start)) >= -1e-12).all()  # and never back


@given(points, points, durations, st.floats(1.0, 5.0))
def test_it_rests_after_t_f(start, goal, t_f, share):
    (motion,) = quintic_motion(start, goal, t_f).sample(np.array([share * t_f]))
    np.testing.assert_allclose(motion, [goal, np.zeros(3), np.zeros(3)], atol=1e-12)


def test_the_distance_to_the_path_goes_to_its_nearest_point():
    quintic = quintic_motion(np.zeros(3), np.array([2.0, 0.0, 0.0]), 3.0)
    found = quintic.distance_to_path(np.array([[0.5, 3.0, 4.0], [-3.0, 4.0, 0.0], [5.0, 0.0, 4.0]]))
    np.testing.assert_allclose(found, [5.0, 5.0, 5.0])


def test_it_is_tracked_and_its_rest_is_seen_for_1_s():
    quintic = build(QuinticConfig(kind="quintic", start=None, goal=[1.0, 2.0, 3.0], duration=3.0), np.zeros(3))
    assert (quintic.duration, quintic.run_duration, quintic.tracked) == (3.0, 4.0, True)
    np.testing.assert_array_equal(quintic.goal, [1.0, 2.0, 3.0])


@pytest.mark.parametrize("duration", [0.0, -1.0])
def test_a_duration_is_positive(duration):
    with pytest.raises(ValueError, match="greater than 0"):
        QuinticConfig(kind="quintic", start=None, goal=[1.0, 2.0, 3.0], duration=duration)
