r"""Start time of a run on the clock of a recording, from the best correlation of their speeds.

.. math:: c(d) = \frac{1}{n} \sum_{j=1}^{n} \frac{\sum_k v_j(t_k)\, w_j(t_k - d)}{|v_j|_d\, |w_j|_d}

v is the speed of a signal in the recording and w in the run, both after the same low-pass filter. The sums and norms
are over the times that both cover. A norm counts at least half of its maximum over all lags, so that no lag with little
motion is chosen.

The maximum is refined by least squares over the positions, each less its mean difference, so that other zeros of the
encoders have no effect.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import linear_sum_assignment, minimize_scalar
from scipy.signal import correlate, find_peaks

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.recordings.smoothing import cutoff, derivative, evenly, low_pass

RESEMBLES = 0.5
"""Correlation of speeds below which a recording is not one of the run's motion."""

_SHORTEST = 0.25  # of the run
_MOST_SAMPLES = 200_000
_STILL = 0.01  # of the largest speed of the run: a signal that is slower tells nothing of the time
_OF_LARGEST = 0.25  # of the square of the largest norm
_AS_GOOD = 0.95  # of the largest correlation
_MORE_COVERED = 1.25  # times what the best lag covers
_CLEARLY = 0.9  # correlation of what is the same motion, though maybe at another rate
_SURELY = 0.98  # above which no other rate is looked for
_STRETCHES = np.geomspace(0.1, 10.0, 157)  # of time that another rate may mean, 3 % from one to the next
_THINNED = 0.01  # s, between the samples at which they are tried


@dataclass(frozen=True)
class Offset:
    """When the run began.

    Attributes:
        start: Time of the recording at which the run's time is zero, in s.
        lags: Such times that were tried, shape (L,), in s.
        correlations: c at each, shape (L,).
        rivals: Other times at which c is nearly as large, in s; the motion repeats itself.
    """

    start: float
    lags: FloatArray
    correlations: FloatArray
    rivals: tuple[float, ...]


def find_offset(
    t: FloatArray, recorded: FloatArray, run_t: FloatArray, simulated: FloatArray, names: Sequence[str]
) -> Offset:
    """Return when a run began on the clock of a recording.

    Args:
        t: Times of the recording, shape (N,), in s.
        recorded: Positions of joints, or coordinates of the tip, shape (N, n).
        run_t: Times of the run, shape (T,), in s.
        simulated: The same signals of the run, shape (T, n).
        names: What they are called.

    Raises:
        RunnerError: if the recording is too short, moves otherwise than the run, against it, in another order of joints
            or at another rate; or the run does not move.
    """
    lasts, run_lasts = t[-1] - t[0], run_t[-1] - run_t[0]
    if lasts < _SHORTEST * run_lasts:
        raise RunnerError(
            f"the recording is too short: it lasts {lasts:.3g} s, and the run {run_lasts:.3g} s; needed: "
            f"{_SHORTEST * run_lasts:.3g} s or more, a quarter of the run (is the unit of its time right?)"
        )
    if lasts > run_lasts / 0.005:
        raise RunnerError(
            f"the recording lasts {lasts:.3g} s, and the run {run_lasts:.3g} s: are its times in ms? say unit: ms for "
            "the time; else cut it to the run's motion"
        )
    lags, correlations, each = _correlate(t, recorded, run_t, simulated)
    best = int(np.argmax(correlations))
    if correlations[best] < _SURELY:
        _check_order(t, recorded, run_t, simulated, names, float(correlations[best]))
    whatever_sign = np.abs(each).sum(axis=1) / max(1, int(np.sum(each.any(axis=0))))
    if correlations[best] < RESEMBLES and whatever_sign.max() > _CLEARLY:
        best = int(np.argmax(whatever_sign))
    best = _at_full_overlap(best, lags, each, whatever_sign, (t[0], t[-1]), (run_t[0], run_t[-1]))
    against = [name for name, value in zip(names, each[best], strict=True) if value < -RESEMBLES]
    if against:
        raise RunnerError(
            f"{' and '.join(against)}: moves against the run; turn the sign of the column, or is it that of another "
            "joint?"
        )
    if correlations[best] < _SURELY:
        _check_likeness(t, recorded, run_t, simulated, float(correlations[best]))
    start = _refined(t, recorded, run_t, simulated, float(lags[best]))
    peaks, _ = find_peaks(correlations, height=_AS_GOOD * correlations[best])
    rivals = tuple(float(lags[peak]) for peak in peaks if peak != best)
    return Offset(start, lags, correlations, rivals)


def _at_full_overlap(
    best: int, lags: FloatArray, each: FloatArray, whatever_sign: FloatArray, log: Sequence[float], run: Sequence[float]
) -> int:
    """Return the place of another lag at which signals fit with opposite signs and much more of both is covered.

    Half a period of a sinusoid looks like a sign: without this an inverted joint would be aligned at another time.
    """
    covered = np.minimum(log[1], run[1] + lags) - np.maximum(log[0], run[0] + lags)
    surely = np.where((whatever_sign > _SURELY) & (each.min(axis=1) < -RESEMBLES), covered, 0.0)
    other = int(np.argmax(surely * whatever_sign))
    return other if surely[other] > _MORE_COVERED * covered[best] else best


def _correlate(
    t: FloatArray, recorded: FloatArray, run_t: FloatArray, simulated: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return lags in s, the mean correlation at each, and that of each signal, shapes (L,), (L,) and (L, n)."""
    step = min(float(np.median(np.diff(t))), float(run_t[1] - run_t[0]))
    step = max(step, max(t[-1] - t[0], run_t[-1] - run_t[0]) / _MOST_SAMPLES)
    frequency = cutoff(max(float(np.median(np.diff(t))), float(run_t[1] - run_t[0])))
    v, w = (_speeds(times, signals, step, frequency) for times, signals in ((t, recorded), (run_t, simulated)))
    speeds = np.sqrt(np.mean(w**2, axis=0))
    moving = speeds > max(_STILL * float(speeds.max()), 1e-9)
    if not moving.any():
        raise RunnerError("the run stands still: there is no motion by which the recording could be aligned with it")
    each = np.zeros((len(v) + len(w) - 1, v.shape[1]))
    for place in np.flatnonzero(moving):
        one, other = v[:, place], w[:, place]
        squares = _energy(one**2, np.ones(len(w))) * _energy(np.ones(len(v)), other**2)
        if squares.min() > 0.0:
            each[:, place] = correlate(one, other, method="fft") / np.sqrt(squares)
    lags = t[0] - run_t[0] + (np.arange(len(each)) - (len(w) - 1)) * step
    return lags, each[:, moving].mean(axis=1), each


def _energy(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the sum of squares over what both cover at each lag, one of them being squares and the other ones."""
    found: FloatArray = correlate(one, other, method="fft")
    return np.maximum(found, _OF_LARGEST * float(found.max()))


def _speeds(t: FloatArray, signals: FloatArray, step: float, frequency: float) -> FloatArray:
    even = t[0] + step * np.arange(int((t[-1] - t[0]) / step + 1e-9) + 1)
    return derivative(low_pass(evenly(t, signals, even), step, frequency), step)


def _refined(t: FloatArray, recorded: FloatArray, run_t: FloatArray, simulated: FloatArray, start: float) -> float:
    """Return the time near another at which the positions of both differ least, signals weighted by their swing."""
    near = 2.0 * max(float(np.median(np.diff(t))), float(run_t[1] - run_t[0]))
    inside = (t - start > run_t[0] + near) & (t - start < run_t[-1] - near)
    path = CubicSpline(run_t, simulated, axis=0)
    swing = np.ptp(simulated, axis=0)
    moving = swing > _STILL * swing.max()

    def distance(later: float) -> float:
        apart = recorded[inside][:, moving] - path(t[inside] - start - later)[:, moving]
        return float(np.sum(np.var(apart, axis=0) / swing[moving] ** 2))

    # From the start on: the tolerance of the search grows with what it searches for.
    found = minimize_scalar(distance, bounds=(-near, near), method="bounded", options={"xatol": 1e-7})
    return start + float(found.x)


def _check_order(
    t: FloatArray, recorded: FloatArray, run_t: FloatArray, simulated: FloatArray, names: Sequence[str], best: float
) -> None:
    """Check that no other order of the columns halves what is lacking to a correlation of 1.

    Raises:
        RunnerError: if one does; names the columns.
    """
    t, recorded, run_t, simulated, count = *_thinned(t, recorded), *_thinned(run_t, simulated), len(names)
    pairs = _correlate(t, np.repeat(recorded, count, axis=1), run_t, np.tile(simulated, count))[2]
    alike = pairs.reshape(-1, count, count)
    at_best = alike[int(np.argmax(alike.max(axis=2).sum(axis=1)))]
    of_run = linear_sum_assignment(-at_best)[1]
    found = at_best[np.arange(count), of_run].sum() / max(1, np.sum(at_best.any(axis=0)))
    others = [f"{names[own]} moves as {names[other]} should" for own, other in enumerate(of_run) if own != other]
    if others and found > max(_CLEARLY, 0.5 * (1.0 + best)):
        raise RunnerError(f"{', '.join(others)}: are the joints in another order?")


def _thinned(t: FloatArray, signals: FloatArray) -> tuple[FloatArray, FloatArray]:
    every = max(1, round(_THINNED / float(np.median(np.diff(t)))))
    return t[::every], signals[::every]


def _check_likeness(t: FloatArray, recorded: FloatArray, run_t: FloatArray, simulated: FloatArray, best: float) -> None:
    """Check that a recording which correlates with the run by `best` at most is of its motion, at the rate said.

    Raises:
        RunnerError: if another rate halves what is lacking to a correlation of 1, or it correlates too little at any.
    """
    period = float(np.median(np.diff(t)))
    t, recorded, run_t, simulated = *_thinned(t, recorded), *_thinned(run_t, simulated)

    def likeness(stretch: float) -> float:
        stretched = t[0] + stretch * (t - t[0])
        if stretched[-1] - stretched[0] < _SHORTEST * (run_t[-1] - run_t[0]):
            return 0.0
        return float(_correlate(stretched, recorded, run_t, simulated)[1].max())

    coarse = _STRETCHES[int(np.argmax([likeness(stretch) for stretch in _STRETCHES.tolist()]))]
    bounds = (coarse / 1.03, coarse * 1.03)
    fine = minimize_scalar(lambda stretch: -likeness(stretch), bounds=bounds, method="bounded", options={"xatol": 1e-4})
    told = f"the recording does not move as the run does: its speeds correlate with the run's by {best:.2f} at most"
    if -fine.fun > max(_CLEARLY, 0.5 * (1.0 + best)):
        rate = 1.0 / (float(fine.x) * period)
        raise RunnerError(
            f"{told} at {1.0 / period:.4g} Hz, and by {-fine.fun:.2f} at about {rate:.3g} Hz: is that the rate "
            "of its rows?"
        )
    if best < RESEMBLES:
        raise RunnerError(f"{told}; needed: {RESEMBLES}; is it of the same motion, and are its joints the right ones?")
