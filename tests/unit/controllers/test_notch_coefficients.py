"""Coefficients of the notch against those of SciPy, bit by bit."""

import numpy as np
from scipy.signal import iirnotch

from runner.controllers.notch import Notch


def test_they_are_those_of_scipy_for_each_joint_and_none_where_the_frequency_is_infinite():
    rng = np.random.default_rng(0)
    for period in 10.0 ** rng.uniform(-4.0, -1.0, 200):
        frequency, width = rng.uniform(1e-3, 0.499, 2) / period
        numbers = Notch(np.array([frequency, np.inf]), float(width), float(period)).parameters
        b, a = iirnotch(frequency, frequency / width, 1.0 / period)
        assert np.array_equal(numbers.b, np.column_stack([b, [1.0, 0.0, 0.0]]))
        assert np.array_equal(numbers.a, np.column_stack([a[1:], [0.0, 0.0]]))
