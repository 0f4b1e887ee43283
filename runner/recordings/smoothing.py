"""Smoothing of signals without delay, and their derivatives."""

from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from runner.base.arrays import FloatArray

CUTOFF = 10.0
"""Of the low-pass, in Hz: above what arms follow, below most of what encoders and motors add."""

_ORDER = 4
_OF_RATE = 5.0  # a slower recording is cut off at this part of its rate


def cutoff(period: float) -> float:
    """Return the cut-off frequency, in Hz, of signals with a time between two samples, in s."""
    return min(CUTOFF, 1.0 / (_OF_RATE * period))


def low_pass(signals: FloatArray, period: float, frequency: float) -> FloatArray:
    """Return signals behind a Butterworth low-pass that runs forward and backward, so that it delays nothing.

    Args:
        signals: Even samples, shape (N, ...).
        period: Time between two samples, in s.
        frequency: Cut-off, in Hz.
    """
    sections = _sections(frequency, period)
    padding = min(len(signals) - 2, round(3.0 / (frequency * period)))
    smooth: FloatArray = sosfiltfilt(sections, signals, axis=0, padlen=padding)
    return smooth


@lru_cache(maxsize=64)
def _sections(frequency: float, period: float) -> FloatArray:
    """Return the low-pass as second-order sections."""
    sections: FloatArray = butter(_ORDER, frequency, fs=1.0 / period, output="sos")
    return sections


def derivative(signals: FloatArray, period: float) -> FloatArray:
    """Return the time derivative of even samples, that of the cubic spline through them, shape (N, ...)."""
    t = period * np.arange(len(signals))
    slope: FloatArray = CubicSpline(t, signals, axis=0)(t, 1)
    return slope


def evenly(t: FloatArray, signals: FloatArray, times: FloatArray) -> FloatArray:
    """Return signals at other times, by the cubic spline through their rows.

    Args:
        t: Times of the rows, shape (N,), in s.
        signals: Shape (N, ...).
        times: Shape (M,), in s, within t.
    """
    between: FloatArray = CubicSpline(t, signals, axis=0)(times)
    return between
