"""Turning values: the values of a choice at which a difference of two sides changes its sign.

All points share their random draws. So the difference of a pair is a smooth function of the choice, and the doubt of
the turning value is the set of values at which the interval of the difference contains zero. That set contains the true
value as often as the interval contains the true difference (Fieller, J. R. Statist. Soc. B 16, 1954).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from runner.base.arrays import FloatArray
from runner.statistics.interval import CONFIDENCE
from runner.statistics.paired import SignedRanks

POINTS = 5
"""Points along a choice between which changes of sign are looked for."""

PAIRS = 24
"""Pairs of a point."""

_ROUNDS = 4  # of new points at the roots
_CLOSE = 0.1  # of the span of a turning value: distance of a root from a known point at which the search ends
_HALVINGS = 30

Ask = Callable[[Sequence[float]], Sequence[FloatArray]]
"""Function of some values of the choice that returns the differences B - A of the pairs at each, shape (n,).

They are infinite if a run failed. The function may return fewer than asked for; then the search ends."""


@dataclass(frozen=True)
class Turn:
    """A turning value.

    Attributes:
        value: Value at which the estimate of the difference is zero.
        low: Lower end of the 95 % span; None if the tried values do not contain it.
        high: Upper end.
        between: The neighbouring allowed values with different signs, if the choice has discrete values; None for a
            continuous choice.
    """

    value: float
    low: float | None
    high: float | None
    between: tuple[float, float] | None = None


def find_turns(ask: Ask, points: Sequence[float], allowed: Sequence[float] | None = None) -> list[Turn]:
    """Return all turning values between some points.

    Runs at the points and at the roots of the estimate and of both ends of its interval. A point with a failed run ends
    a bracket: no root is looked for next to it.

    Args:
        ask: Function that simulates some values of the choice.
        points: The first points, ascending.
        allowed: The allowed values of a choice that has discrete values, ascending; None for a continuous choice.
    """
    known: dict[float, FloatArray] = {}

    def add(values: Sequence[float]) -> bool:
        snapped = {value if allowed is None else _nearest(value, allowed) for value in values}
        new = sorted(snapped - known.keys())
        found = ask(new) if new else ()
        known.update(zip(new, found, strict=False))
        return bool(found)

    add(points)
    for _ in range(_ROUNDS):
        roots = [root for which in range(3) for root in _roots(known, which)]
        spans = [
            turn.high - turn.low for turn in _turns(known, allowed) if turn.low is not None and turn.high is not None
        ]
        close = _CLOSE * min(spans, default=(max(points) - min(points)) / (len(points) - 1))
        if not add([root for root in roots if min(abs(root - value) for value in known) > close]):
            break
    return _turns(known, allowed)


def _turns(known: dict[float, FloatArray], allowed: Sequence[float] | None) -> list[Turn]:
    middle, ends = _roots(known, 0), sorted([*_roots(known, 1), *_roots(known, 2)])
    found = []
    for root in middle:
        low = max((end for end in ends if end <= root), default=None)
        high = min((end for end in ends if end >= root), default=None)
        between = None
        if allowed is not None:
            below = max((value for value in allowed if value <= root), default=min(allowed))
            above = min((value for value in allowed if value >= root), default=max(allowed))
            between = below, above
        found.append(Turn(root, low, high, between))
    return found


def _roots(known: dict[float, FloatArray], which: int) -> list[float]:
    """Return the zeros of the estimate (0), the lower end (1) or the upper end (2) between neighbouring points."""
    return [root for segment in pairwise(sorted(known)) for root in _root_between(known, segment, which)]


def _root_between(known: dict[float, FloatArray], segment: tuple[float, float], which: int) -> Iterator[float]:
    """Yield the zero of a statistic between two points, over which the difference of each pair is linear."""
    start, end = known[segment[0]], known[segment[1]]
    if not (np.isfinite(start).all() and np.isfinite(end).all()):
        return
    left, right = _statistic(start, which), _statistic(end, which)
    if left is None or right is None or left * right > 0.0 or left == right or right == 0.0:
        return
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        share = (low + high) / 2.0
        value = _statistic((1.0 - share) * start + share * end, which)
        if value is None:
            return
        low, high = (share, high) if value * left > 0.0 else (low, share)
    yield segment[0] + (low + high) / 2.0 * (segment[1] - segment[0])


def _statistic(differences: FloatArray, which: int) -> float | None:
    ranks = SignedRanks(differences)
    if which == 0:
        return ranks.estimate
    ends = ranks.interval(1.0 - CONFIDENCE)
    return None if ends is None else ends[which - 1]


def _nearest(value: float, allowed: Sequence[float]) -> float:
    return min(allowed, key=lambda each: abs(each - value))
