"""Quintic blend: ends, symmetry and derivatives."""

import numpy as np

from runner.trajectories.blend import quintic_blend


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
