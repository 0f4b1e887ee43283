"""Smoothing of signals without delay, and their derivatives."""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg.lapack import dtbtrs

from runner.base.arrays import FloatArray

CUTOFF = 10.0
"""Of the low-pass, in Hz: above what arms follow, below most of what encoders and motors add."""

_QUALITIES = 0.5 / np.cos(np.pi * np.array([1.0, 3.0]) / 8.0)  # of both sections of a Butterworth filter of order 4
_OF_RATE = 5.0  # a slower recording is cut off at this part of its rate


def cutoff(period: float) -> float:
    """Return the cut-off frequency, in Hz, of signals with a time between two samples, in s."""
    return min(CUTOFF, 1.0 / (_OF_RATE * period))


def low_pass(signals: FloatArray, period: float, frequency: float) -> FloatArray:
    """Return signals behind a Butterworth low-pass of order 4, run forward and backward so that it delays nothing.

    Beyond both ends the signals go on as mirrored at their last point.

    Args:
        signals: Even samples, shape (N, ...).
        period: Time between two samples, in s.
        frequency: Cut-off, in Hz.
    """
    if not signals.size:
        return signals.copy()
    padding = min(len(signals) - 2, round(3.0 / (frequency * period)))
    before, after = 2.0 * signals[0] - signals[padding:0:-1], 2.0 * signals[-1] - signals[-2 : -2 - padding : -1]
    smooth = np.concatenate([before, signals, after]).reshape(len(signals) + 2 * padding, -1)
    for _ in range(2):
        smooth = _one_way(smooth, np.tan(np.pi * frequency * period))[::-1]
    return smooth[padding : padding + len(signals)].reshape(signals.shape)


def _one_way(signals: FloatArray, edge: float) -> FloatArray:
    """Return signals behind both sections, which have rested at the first row, shape (N, n).

    A section is the bilinear transform of 1 / (s^2 + s / Q + 1) with s = (z - 1) / (z + 1) / edge.
    """
    first = signals[0]
    passed = np.asfortranarray(signals - first)
    for quality in _QUALITIES.tolist():
        scale = 1.0 + edge / quality + edge**2
        before, earlier = 2.0 * (edge**2 - 1.0) / scale, (1.0 - edge / quality + edge**2) / scale
        passed[1:] += passed[:-1]
        passed[1:] += passed[:-1]
        passed *= edge**2 / scale
        bands = np.tile([[1.0], [before], [earlier]], len(passed))
        passed = dtbtrs(bands, passed, uplo="L", diag="U", overwrite_b=True)[0]
    return np.asarray(passed + first, dtype=np.float64)


def acceleration_noise(deviations: FloatArray, period: float, frequency: float) -> FloatArray:
    r"""Return the standard deviation of second derivatives of white noise behind a low-pass, shape (n,).

    .. math:: s = \sigma \, (2 \pi)^2 \sqrt{2 T f^5 / 5}

    Args:
        deviations: That of the noise, sigma, shape (n,).
        period: Time between two samples, T, in s.
        frequency: Cut-off, f, in Hz.
    """
    found: FloatArray = deviations * (2.0 * np.pi) ** 2 * np.sqrt(0.4 * period * frequency**5)
    return found


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
