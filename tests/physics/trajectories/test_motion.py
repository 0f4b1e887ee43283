"""Motions along a path, and the quintic blend."""

import numpy as np
import pytest

from runner.trajectories.circle import Circle
from runner.trajectories.motion import PathMotion, quintic_blend


def test_it_goes_from_0_to_1_and_rests_at_and_beyond_both():
    np.testing.assert_array_equal(quintic_blend(np.array([-1.0, 0.0, 1.0, 2.0])), [[0, 0, 1, 1], [0] * 4, [0] * 4])


def test_it_is_odd_about_the_middle_where_its_slope_is_largest():
    u = np.linspace(0.0, 1.0, 101)
    s, s_prime, s_second = quintic_blend(u)
    np.testing.assert_allclose(s + s[::-1], 1.0, atol=1e-15)
    assert (s_prime.argmax(), s_prime.max()) == (50, 1.875)
    assert (np.diff(s) > 0.0).all()
    np.testing.assert_allclose(s_second, -s_second[::-1], atol=1e-14)


def test_each_is_the_derivative_of_the_one_before():
    u = np.linspace(0.0, 1.0, 7)[1:-1]
    before, here, after = (np.array(quintic_blend(u + h)) for h in (-1e-5, 0.0, 1e-5))
    np.testing.assert_allclose((after - before)[:2] / 2e-5, here[1:], atol=1e-8)


CIRCLE = Circle(np.zeros(3), 1.0, np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]), 1)
T_F = 2.0


def test_an_even_motion_has_the_speed_and_acceleration_of_a_turning_point():
    figure, times = PathMotion(CIRCLE, T_F, "none"), np.linspace(0.0, 5.0, 7)
    rate, motion = 2.0 * np.pi / T_F, figure.sample(times)
    np.testing.assert_allclose(np.linalg.norm(motion[:, 1], axis=1), rate, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(motion[:, 2], axis=1), rate**2, rtol=1e-12)
    np.testing.assert_allclose(figure.sample(times + T_F), motion, atol=1e-12)  # over and over
    assert figure.goal is None
    assert figure.run_duration == T_F


def test_a_quintic_goes_once_from_rest_to_rest():
    figure = PathMotion(CIRCLE, T_F, "quintic")
    ends = figure.sample(np.array([0.0, T_F, 3.0 * T_F]))
    np.testing.assert_allclose(ends, 0.0, atol=1e-12)
    np.testing.assert_allclose(figure.sample(np.array([0.5 * T_F]))[0, 0], [0.0, 2.0, 0.0], atol=1e-12)
    np.testing.assert_array_equal(figure.goal, figure.start)
    assert figure.run_duration == T_F + 1.0


@pytest.mark.parametrize("easing", ["none", "quintic"])
def test_derivatives_are_those_of_the_motion(easing):
    figure, times, h = PathMotion(CIRCLE, T_F, easing), np.linspace(0.2, 1.8, 5), 1e-5
    before, now, after = (figure.sample(times + step) for step in (-h, 0.0, h))
    np.testing.assert_allclose(now[:, 1:], (after - before)[:, :2] / (2.0 * h), rtol=1e-7, atol=1e-7)
