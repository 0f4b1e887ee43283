"""Residuals of a recording against sums by hand."""

import numpy as np
import pytest

from runner.recordings.columns_map import Signal
from runner.recordings.compare import Residual

T = np.linspace(0.0, 1.0, 1001)
SINE = np.sin(2.0 * np.pi * T)


def residual(recorded, simulated):
    return Residual(Signal("position", "q1"), "rad", T, recorded, simulated)


def test_numbers_of_a_residual():
    one = residual(SINE + 0.1, SINE)
    assert (one.mean, one.rms, one.largest) == pytest.approx((0.1, 0.1, 0.1))
    two = residual(1.2 * SINE, SINE)
    assert (two.mean, two.rms, two.largest) == pytest.approx((0.0, 0.2 / np.sqrt(2.0), 0.2), abs=1e-3)


def test_the_fit_is_one_less_the_normalised_root_mean_square_error():
    assert residual(SINE, SINE).fit == 1.0
    assert residual(SINE, np.zeros(1001)).fit == pytest.approx(0.0, abs=1e-12)
    assert residual(1.25 * SINE, SINE).fit == pytest.approx(0.8)
    assert residual(np.ones(1001), SINE).fit is None
