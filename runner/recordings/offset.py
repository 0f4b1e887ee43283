r"""Start time of a run on the clock of a recording, from the best correlation of their speeds.

.. math:: c(d) = \frac{1}{n} \sum_{j=1}^{n} \frac{\sum_k v_j(t_k)\, w_j(t_k - d)}{|v_j|_d\, |w_j|_d}

v is the speed of a signal in the recording and w in the run, both after the same low-pass filter. The sums and norms
are over the times that both cover. A norm counts at least half of its maximum over all lags, so that no lag with little
motion is chosen.

The correlation of a log that is cut off in motion has its maximum next to the right lag, as the ends weigh against it.
So each of its peaks is moved to the nearest minimum of the differences of positions, each less its mean difference, so
that other zeros of the encoders have no effect. The peak with the smallest differences is chosen. Where several are
alike, the arm is asked to rest before and after the run, if the run does; and then the lag that covers most is chosen.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import linear_sum_assignment, minimize_scalar

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
_PEAK = 0.8  # of the largest correlation, from which on a peak is tried
_MOST_PEAKS = 40
_MOST_ROWS = 5_000  # at which peaks are compared
_ALIKE = 1.5  # times the least mean square of differences: what fits as well
_LEAST_SQUARE = 1e-8  # of the square of the swing: rounding and interpolation
_FARTHEST = 0.1  # s, from a peak of the correlation to a minimum of the differences, or five windows
_WINDOW = 2e-3  # s, half of it at least
_AT_BOUND = 0.98  # of the window
_RESTING = 0.01  # of the largest speed of a signal
_VISIBLY = 0.05  # of the swing of a signal, in a time in which an arm outside of the run must rest
_AS_LONG = 0.01  # relative difference of the lengths of a log and of the run whose motion was made from it
_LONGEST_LAG = 0.5  # s, of a joint behind its command
_SAME = 0.02  # s, between two minima that are one
_FEWEST = 10  # rows
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
        rivals: Other times at which positions fit as well, in s; the motion repeats itself, and the log does not tell.
        open_ended: Whether no minimum of the differences was found near it: the differences still decrease there.
    """

    start: float
    lags: FloatArray
    correlations: FloatArray
    rivals: tuple[float, ...]
    open_ended: bool = False


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
    between = correlations[1:-1]
    is_peak = (between > correlations[:-2]) & (between >= correlations[2:]) & (between >= _PEAK * correlations[best])
    peaks = np.flatnonzero(is_peak) + 1
    peaks = np.append(best, peaks[np.argsort(-correlations[peaks])][:_MOST_PEAKS])
    match = _Match(t, recorded, run_t, simulated)
    start, rivals, open_ended = _chosen(match, lags[peaks].tolist())
    return Offset(start, lags, correlations, rivals, open_ended)


def find_lag(t: FloatArray, measured: FloatArray, commanded: FloatArray) -> float:
    """Return the time by which a joint moves later than its command, in s, by the least differences of positions.

    Args:
        t: Times, shape (N,), in s.
        measured: Positions, shape (N,), in rad.
        commanded: Commanded ones at the same times.
    """
    pair = measured[:, None], t, commanded[:, None]
    lags, correlations, _ = _correlate(t, *pair)
    near = np.abs(lags) <= _LONGEST_LAG
    return _Match(t, *pair).refined(float(lags[near][int(np.argmax(correlations[near]))]))[0]


def _at_full_overlap(
    best: int, lags: FloatArray, each: FloatArray, whatever_sign: FloatArray, log: Sequence[float], run: Sequence[float]
) -> int:
    """Return the place of another lag at which signals fit with opposite signs and much more of both is covered.

    Half a period of a sinusoid looks like a sign: without this an inverted joint would be aligned at another time.
    """
    covered = np.minimum(log[1], run[1] + lags) - np.maximum(log[0], run[0] + lags)
    surely = np.where((whatever_sign > _SURELY) & (each.min(axis=1) < -RESEMBLES), covered, 0.0)
    other = int(np.argmax(surely * whatever_sign))
    # A motion that repeats itself fits elsewhere, too.
    fits = each.sum(axis=1)
    alike = covered[fits >= min(_AS_GOOD * fits[best], fits[best])].max()
    return other if surely[other] > _MORE_COVERED * alike else best


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
            each[:, place] = _products(one, other) / np.sqrt(squares)
    lags = t[0] - run_t[0] + (np.arange(len(each)) - (len(w) - 1)) * step
    return lags, each[:, moving].mean(axis=1), each


def _products(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the sum of products of two signals at each lag of the one, shapes (N,) and (M,) to (N + M - 1,)."""
    count = len(one) + len(other) - 1
    size = 1 << (count - 1).bit_length()
    products: FloatArray = np.fft.irfft(np.fft.rfft(one, size) * np.fft.rfft(other[::-1], size), size)[:count]
    return products


def _energy(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the sum of squares over what both cover at each lag, one of them being squares and the other ones."""
    found = _products(one, other)
    return np.maximum(found, _OF_LARGEST * float(found.max()))


def _speeds(t: FloatArray, signals: FloatArray, step: float, frequency: float) -> FloatArray:
    even = t[0] + step * np.arange(int((t[-1] - t[0]) / step + 1e-9) + 1)
    return derivative(low_pass(evenly(t, signals, even), step, frequency), step)


class _Match:
    """Positions of a recording and of a run, whose difference depends on when the run began."""

    def __init__(self, t: FloatArray, recorded: FloatArray, run_t: FloatArray, simulated: FloatArray) -> None:
        swing = np.ptp(simulated, axis=0)
        self._moving = swing > _STILL * swing.max()
        self._swing = swing[self._moving]
        self._t, self._recorded = t, recorded[:, self._moving]
        self._run_t, self._path = run_t, CubicSpline(run_t, simulated[:, self._moving], axis=0)
        self._near = max(_WINDOW, 2.0 * max(float(np.median(np.diff(t))), float(np.median(np.diff(run_t)))))

    def thinned(self) -> "_Match":
        """Return it with few enough rows to compare many times."""
        every = max(1, len(self._t) // _MOST_ROWS)
        return _Match(self._t[::every], self._recorded[::every], self._run_t, self._path(self._run_t))

    def covered(self, start: float) -> float:
        """Return the time that both cover, in s."""
        return float(min(self._t[-1], self._run_t[-1] + start) - max(self._t[0], self._run_t[0] + start))

    def refined(self, start: float) -> tuple[float, float, bool]:
        """Return the time near another at which positions differ least, their mean square, and if the search ended.

        Rows and signals are those of the first time, so that one time is compared with another over the same rows.
        """
        near, first, square = self._near, start, np.inf
        while abs(start - first) <= max(_FARTHEST, 5.0 * near):
            inside = (self._t - start > self._run_t[0] + near) & (self._t - start < self._run_t[-1] - near)
            if np.count_nonzero(inside) < _FEWEST:
                return start, np.inf, True
            t, recorded = self._t[inside] - start, self._recorded[inside]

            def apart(later: float, t: FloatArray = t, recorded: FloatArray = recorded) -> float:
                return float(np.mean(np.var(recorded - self._path(t - later), axis=0) / self._swing**2))

            # From the start on: the tolerance of the search grows with what it searches for.
            found = minimize_scalar(apart, bounds=(-near, near), method="bounded", options={"xatol": 1e-7})
            start, square = start + float(found.x), float(found.fun)
            if abs(found.x) < _AT_BOUND * near:
                return start, square, False
        return start, square, True

    def whole(self, start: float) -> bool:
        """Return whether the recording covers a whole run that rests at an end or has the recording's length."""
        lasts, logged = self._run_t[-1] - self._run_t[0], self._t[-1] - self._t[0]
        known = bool(self._resting_ends) or abs(logged - lasts) < _AS_LONG * lasts
        return bool(known and self.covered(start) > lasts - max(2.0 * self._near, _AS_LONG * lasts))

    def rests(self, start: float) -> bool:
        """Return whether the recording rests before and after the run, where the run starts and ends at rest."""
        for end, lasts, side in self._resting_ends:
            later = side * (self._t - start - end)
            held = self._recorded[(later > 0.0) & (later < lasts)]
            if len(held) and (np.ptp(held, axis=0) > _RESTING * self._swing).any():
                return False
        return True

    @cached_property
    def _resting_ends(self) -> list[tuple[float, float, float]]:
        """Ends of the run at rest: time, time that the run moves visibly in, and -1 or 1 for start or end."""
        positions, fastest = self._path(self._run_t), np.abs(self._path(self._run_t, 1)).max(axis=0)
        ends = []
        for row, side in ((0, -1.0), (-1, 1.0)):
            end = float(self._run_t[row])
            if (np.abs(self._path(end, 1)) < _RESTING * fastest).all():
                gone = (np.abs(positions - positions[row]) > _VISIBLY * self._swing).any(axis=1)
                ends.append((end, float(np.abs(self._run_t[gone] - end).min()), side))
        return ends


def _chosen(match: _Match, starts: Sequence[float]) -> tuple[float, tuple[float, ...], bool]:
    """Return when a run began, from some times to start from; other times that fit as well; if the search ended."""
    quick = match.thinned()
    tried = [quick.refined(start) for start in starts]
    least = _ALIKE * max(_LEAST_SQUARE, min(square for _, square, _ in tried))
    alike = [start for start, square, _ in tried if square <= least] or [starts[0]]
    for better in (quick.rests, quick.whole):
        alike = [start for start in alike if better(start)] or alike
    best = max(alike, key=quick.covered)
    start, _, open_ended = match.refined(best)
    rivals = {round(other, 4) for other in alike if abs(other - best) > _SAME}
    return start, tuple(sorted(rivals)), open_ended


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
