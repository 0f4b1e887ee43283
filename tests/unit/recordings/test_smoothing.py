"""Smoothing of recordings: the cut-off over the rate, and what the low-pass leaves of sines."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from runner.recordings.smoothing import CUTOFF, cutoff, low_pass


@pytest.mark.parametrize(
    ("rate", "expected"),
    [(20.0, 4.0), (40.0, 8.0), (45.0, 9.0), (49.0, 9.8), (50.0, CUTOFF), (51.0, CUTOFF), (1e3, CUTOFF)],
)
def test_slow_recordings_are_cut_off_at_a_fifth_of_their_rate(rate, expected):
    assert cutoff(1.0 / rate) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("frequency", "gain"), [(2.0, 1.0), (CUTOFF, 0.5), (40.0, 0.0)])
def test_the_low_pass_halves_its_frequency_and_delays_nothing(frequency, gain):
    """Forward and backward: of the amplitude at the cut-off half is left, the power at -3 dB twice."""
    times = np.arange(0.0, 4.0, 0.002)
    wave = np.sin(2.0 * np.pi * frequency * times)
    middle = slice(500, 1500)
    assert low_pass(wave, 0.002, CUTOFF)[middle] == pytest.approx(gain * wave[middle], abs=5e-3)


@pytest.mark.parametrize(("rows", "rate", "frequency"), [(4_000, 500.0, CUTOFF), (300, 50.0, 24.0), (3, 50.0, 10.0)])
def test_the_low_pass_is_that_of_scipy(rows, rate, frequency):
    walk = np.cumsum(np.random.default_rng(1).normal(size=(rows, 2, 3)), axis=0)
    padding = min(rows - 2, round(3.0 * rate / frequency))
    expected = sosfiltfilt(butter(4, frequency, fs=rate, output="sos"), walk, axis=0, padlen=padding)
    assert low_pass(walk, 1.0 / rate, frequency) == pytest.approx(expected, rel=1e-10, abs=1e-10)


def test_the_low_pass_of_no_signals_is_empty():
    assert low_pass(np.zeros((100, 0)), 0.01, CUTOFF).shape == (100, 0)
