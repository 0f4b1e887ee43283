"""Smoothing of recordings: the cut-off over the rate, and what the low-pass leaves of sines."""

import numpy as np
import pytest

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
