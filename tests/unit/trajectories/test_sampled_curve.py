"""Curve through samples: polynomials of fifth order, which it keeps, and SciPy's BPoly on uneven samples."""

import numpy as np
import pytest
from scipy.interpolate import BPoly

from runner.trajectories.sampled_curve import SampledCurve


def test_a_polynomial_of_fifth_order_is_kept_with_its_derivatives():
    motion = np.polynomial.Polynomial([0.3, -1.0, 0.5, 2.0, -0.7, 0.2])
    orders = [motion, motion.deriv(1), motion.deriv(2)]
    times, between = np.array([0.0, 0.4, 1.5]), np.linspace(0.0, 1.5, 41)
    samples, expected = (np.stack([order(t) for order in orders], axis=1)[:, :, None] for t in (times, between))
    assert SampledCurve(times, samples).sample(between) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_it_is_the_curve_of_scipy_at_samples_and_between_them():
    rng = np.random.default_rng(0)
    times, samples = np.cumsum(rng.uniform(0.1, 1.0, 20)), rng.normal(size=(20, 3, 3))
    curve = BPoly.from_derivatives(times, samples)
    at = np.concatenate([times, rng.uniform(times[0], times[-1], 200)])
    expected = np.stack([curve(at), curve.derivative(1)(at), curve.derivative(2)(at)], axis=1)
    for order in range(3):
        size = np.abs(expected[:, order]).max()
        assert SampledCurve(times, samples).sample(at)[:, order] == pytest.approx(expected[:, order], abs=1e-13 * size)
