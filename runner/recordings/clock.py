"""Times of a log's rows: rounding, order, repeats and gaps."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError

_ROUNDINGS = (0.01, 0.001)  # s
_OFF_EVEN = 0.75  # of the rounding: what even rows may differ from it, with some drift of the clock
_EXACT = 1e-4  # of the rounding
_BACK = 1.0  # s: a row that is farther back belongs to another log
_SWAPPED, _REPEATED = 0.05, 0.6  # of all rows
_GAP = 2.5  # usual times between two rows
_SHORTEST_GAP = 0.02  # s: half of what the low-pass of 10 Hz leaves of a motion takes longer
_MANY = 0.05  # of the rows: from there on rows that repeat positions are left out
_GOES_ON = 2.5  # resolutions of an encoder: a joint that steps by more on both sides of rows moves in them


class Clock(NamedTuple):
    """Times of rows in order.

    Attributes:
        t: Times since the first row, in s, shape (M,).
        rows: The row of the log of each, shape (M,).
        notes: Messages for a user.
    """

    t: FloatArray
    rows: NDArray[np.intp]
    notes: Sequence[str]


def read_clock(t: FloatArray, place: Callable[[int], str]) -> Clock:
    """Return the times of a log in order, once each.

    Args:
        t: Times of the rows since the first one, in s, shape (N,).
        place: Function of a row's index that returns its label.

    Raises:
        RunnerError: if a time is missing, or the times are no clock of one log; the message has no path.
    """
    missing = np.isnan(t)
    if missing.any():
        raise RunnerError(f"{place(int(np.argmax(missing)))}: the time is missing, in {missing.sum()} of {len(t)} rows")
    rows, steps = np.arange(len(t)), np.diff(t)
    if rounding := _rounding(t, steps):
        even = np.polynomial.Polynomial.fit(rows, t, 1)(rows)
        period = float(even[1] - even[0])
        return Clock(even - even[0], rows, [f"times are rounded to {1e3 * rounding:g} ms: rows are taken as even, "
                                            f"{1e3 * period:.4g} ms apart"])  # fmt: skip
    notes = []
    back = np.flatnonzero(steps < 0.0)
    if len(back):
        worst = int(np.argmin(steps))
        if steps[worst] < -_BACK or len(back) > _SWAPPED * len(t):
            raise RunnerError(
                f"{place(worst + 1)}: the time is {t[worst + 1]:g} s after {t[worst]:g} s, and runs back in "
                f"{len(back)} rows; cut the file to one log"
            )
        rows = np.argsort(t, kind="stable")
        t = t[rows]
        notes.append(f"{len(back)} times run back: the rows are sorted by time")
    again = np.append(False, np.diff(t) <= 0.0)
    if again.sum() > _REPEATED * len(t):
        raise RunnerError(
            f"the time has {np.sum(~again)} values in {len(t)} rows; say rate: instead of time:, if rows are even"
        )
    if again.any():
        notes.append(f"{again.sum()} rows repeat the time of the row before and are left out")
    return Clock(t[~again] - t[0], rows[~again], notes)


def _rounding(t: FloatArray, steps: FloatArray) -> float:
    """Return the rounding of the times of even rows, in s; 0 without one."""
    if len(t) < 3 or (steps < 0.0).any() or np.ptp(steps) < _EXACT * _ROUNDINGS[-1]:
        return 0.0
    rows, exact = np.arange(len(t)), _EXACT * np.maximum(1.0, 1e-6 * t[-1] / np.array(_ROUNDINGS))
    off = np.abs(t - np.polynomial.Polynomial.fit(rows, t, 1)(rows)).max()
    for rounding, most in zip(_ROUNDINGS, exact.tolist(), strict=True):
        if off < _OFF_EVEN * rounding and np.abs(t / rounding - np.round(t / rounding)).max() < most:
            return rounding
    return 0.0


def without_repeats(clock: Clock, positions: FloatArray) -> Clock:
    """Return the rows without those that repeat the positions of the row before, if many do so in motion.

    Rows between two changes of positions are a stretch. A joint moves in it if it steps in the same direction before
    and after it, by some resolutions of its encoder: in slow motion it steps by one. Of a stretch in motion the first
    row stays, unless it lasts too long for jitter. Of the other stretches, as at rest, each n-th row stays, where n is
    the usual number of rows of a stretch in motion. So the rows of a state that is slower than its log are even.

    Args:
        clock: Times and rows.
        positions: Positions in these rows, shape (M, n).
    """
    steps = np.diff(positions, axis=0)
    first = np.append(0, np.flatnonzero((steps != 0.0).any(axis=1)) + 1)
    resolution = np.min(np.abs(steps), axis=0, where=np.abs(steps) > 0.0, initial=np.inf)
    changes = np.diff(positions[first], axis=0)
    ways = np.sign(changes) * (np.abs(changes) > _GOES_ON * resolution)
    moving = np.zeros(len(first), dtype=np.bool_)
    moving[1:-1] = (ways[1:] * ways[:-1] > 0.0).any(axis=1)
    if not moving.any():
        return clock
    counts = np.diff(np.append(first, len(clock.t)))
    lasting = np.diff(np.append(clock.t[first], clock.t[-1]))
    short = lasting <= longest_step(float(np.median(lasting[moving])))
    usual = max(1, round(float(np.median(counts[moving]))))
    if (counts[moving & short] - 1).sum() <= _MANY * counts[short].sum():
        return clock
    place = np.arange(len(clock.t)) - np.repeat(first, counts)
    kept = np.where(np.repeat(moving & short, counts), place, place % usual) == 0
    note = f"{np.sum(~kept):,} of {len(kept):,} rows repeat the positions of the row before and are left out"
    return Clock(clock.t[kept], clock.rows[kept], [*clock.notes, note])


def longest_step(period: float) -> float:
    """Return the longest time between two rows that is jitter and no gap, in s, from the usual time."""
    return max(_GAP * period, _SHORTEST_GAP) * (1.0 + 1e-6)
