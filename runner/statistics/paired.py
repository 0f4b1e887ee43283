"""Paired comparison of two configs on the same seeds: signed-rank test, its interval, and Holm correction."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.statistics.interval import CONFIDENCE, SMALLEST_SAMPLE
from runner.statistics.sample_size import count_pairs, few_pairs, pairs_range, scale

EXACT_UP_TO = 200
"""Differences up to which the distribution is summed up; beyond, the normal law stands in for it."""


class SignedRanks:
    """Paired differences by their Walsh averages: the means of any two of them, and each difference itself.

    The sum of the ranks of the positive differences is the number of Walsh averages above zero (Hollander, Wolfe and
    Chicken, Nonparametric Statistical Methods, 2014, sections 3.1 to 3.3). The test counts averages at zero on both
    sides, and the interval holds its ends: so it keeps its level with ties and differences of zero, too (Noether,
    "Wilcoxon confidence intervals for location parameters in the discrete case", JASA 62, 1967), and an interval of a
    level excludes zero exactly if the p-value is below that level.

    Args:
        differences: The differences, shape (n,), n one or more; infinite ones are larger than all others and equal to
            each other.

    Attributes:
        estimate: The Hodges-Lehmann estimate of the difference: the median of the Walsh averages.
    """

    def __init__(self, differences: FloatArray) -> None:
        averages = _walsh_averages(differences)
        self._differences, self._count = differences, len(averages)
        places = [(self._count - 1) // 2, self._count // 2]
        middle = np.partition(averages, places)[places].tolist()
        self.estimate = float(middle[0] if middle[0] == middle[1] else sum(middle) / 2)
        self._at_most = int(np.count_nonzero(averages <= 0.0))
        self._at_least = int(np.count_nonzero(averages >= 0.0))
        self._tail = _lower_tail(len(differences))
        self._intervals: dict[int, tuple[float, float]] = {}

    @property
    def effect(self) -> float:
        """The matched-pairs rank-biserial correlation: -1 with all differences below zero, 1 with all above."""
        return (self._at_least - self._at_most) / self._count

    @property
    def p_value(self) -> float:
        """The two-sided p-value: exact up to EXACT_UP_TO differences, of the normal law beyond."""
        fewer = min(self._at_most, self._at_least)
        return min(1.0, 2.0 * float(self._tail[fewer])) if fewer < len(self._tail) else 1.0

    def interval(self, level: float) -> tuple[float, float] | None:
        """Return the interval that misses the difference with at most a given probability; None with too few pairs."""
        k = int(np.searchsorted(2.0 * self._tail, level))
        if k and k not in self._intervals:  # the averages, half a million for 1000 pairs, are not kept
            ordered = np.partition(_walsh_averages(self._differences), (k - 1, self._count - k))
            self._intervals[k] = float(ordered[k - 1]), float(ordered[self._count - k])
        return self._intervals[k] if k else None


def _walsh_averages(differences: FloatArray) -> FloatArray:
    """Return the means of any two differences, and each difference itself, in no order."""
    one, other = np.triu_indices(len(differences))
    with np.errstate(invalid="ignore"):
        averages: FloatArray = (differences[one] + differences[other]) / 2
    averages[np.isnan(averages)] = 0.0  # of both infinities
    return averages


@lru_cache(maxsize=64)
def _lower_tail(n: int) -> FloatArray:
    """Return the probability of a rank sum of at most 0, 1, 2, ... up to its mean, if each sign is as likely.

    Up to EXACT_UP_TO differences the choices of signs are counted by adding up one rank after another (Pratt and
    Gibbons, Concepts of Nonparametric Theory, 1981, chapter 3).
    """
    total = n * (n + 1) // 2
    if n > EXACT_UP_TO:
        deviation = math.sqrt(n * (n + 1) * (2 * n + 1) / 24)
        from scipy.special import ndtr

        normal: FloatArray = ndtr((np.arange(total // 2 + 1) - total / 2) / deviation)
        return normal
    ways = np.zeros(total // 2 + 1)
    ways[0] = 1.0
    for rank in range(1, n + 1):
        ways[rank:] += ways[:-rank].copy()
    return np.ldexp(np.cumsum(ways), -n)


class Empty(NamedTuple):
    """Repetitions in which neither has a value: they are in no pair, and count nothing.

    Attributes:
        repetitions: Number of these.
        of: Number of all repetitions that both have.
        levels: Number of levels, compared by their mean, at which there are such repetitions.
        of_levels: Number of all these levels.
    """

    repetitions: int = 0
    of: int = 0
    levels: int = 0
    of_levels: int = 1

    def __str__(self) -> str:
        """Return them as a phrase, such as "neither has a value in 24 of 36 repetitions, at 2 of 3 levels"."""
        at = f", at {self.levels} of {self.of_levels} levels" if self.of_levels > 1 else ""
        return f"neither has a value in {self.repetitions} of {self.of} repetitions{at}" if self.repetitions else ""


NONE_EMPTY = Empty()
"""No such repetitions."""


@dataclass(frozen=True, eq=False)
class PairedComparison:
    """Difference of b and a on the same seeds, in the pairs in which either has a value; there may be none.

    Attributes:
        a: Values of the first, one for each pair, shape (n,); infinity is beyond every number.
        b: Values of the second, in the same order.
        differences: b - a.
        error: Typical error of the plants in one difference; None where it is not known.
        rounding: Largest change of a value through rounding, as a fraction; 0 where it is not known.
        exact: True if nothing is drawn, so that one pair gives the difference without doubt.
        empty: Repetitions without any value, which are in no pair.
        left_out: Number of further pairs, which were not chosen.
    """

    a: FloatArray = field(repr=False)
    b: FloatArray = field(repr=False)
    differences: FloatArray = field(repr=False)
    error: float | None = None
    rounding: float = 0.0
    exact: bool = False
    empty: Empty = NONE_EMPTY
    left_out: int = 0

    @property
    def n(self) -> int:
        """Number of pairs."""
        return len(self.differences)

    @property
    def count(self) -> str:
        """The number of pairs, such as "40 pairs" or "1000 of 1500 pairs"."""
        of = f" of {self.n + self.left_out}" if self.left_out else ""
        return f"{self.n}{of} {'pair' if self.n == 1 and not of else 'pairs'}"

    @property
    def medians(self) -> tuple[float, float]:
        """Medians of both; infinite without pairs."""
        if not self.n:
            return math.inf, math.inf
        return float(np.median(self.a)), float(np.median(self.b))

    @property
    def lost(self) -> tuple[int, int]:
        """Number of pairs in which a, and in which b, is beyond every number."""
        return int(np.isinf(self.a).sum()), int(np.isinf(self.b).sum())

    @property
    def difference(self) -> float:
        """The Hodges-Lehmann estimate of b - a; NaN without pairs."""
        return self._ranks.estimate if self.n else math.nan

    @property
    def effect(self) -> float:
        """Matched-pairs rank-biserial correlation, -1 (b smaller in every pair) to 1 (b larger); NaN without pairs."""
        return self._ranks.effect if self.n else math.nan

    @property
    def p_value(self) -> float | None:
        """Two-sided p of only the signed-rank test; None with fewer than SMALLEST_SAMPLE pairs."""
        return self._ranks.p_value if self.n >= SMALLEST_SAMPLE else None

    def interval(self, level: float) -> tuple[float, float] | None:
        """Return the interval of the same test: it excludes zero exactly if p is below the level.

        None with too few pairs for that level.
        """
        return self._ranks.interval(level) if self.n >= SMALLEST_SAMPLE else None

    def pairs_needed(self, difference: float, level: float, least: float = 0.0) -> int | None:
        """Return the number of pairs that show a difference with probability 80 %; None if it cannot be estimated.

        Args:
            difference: The difference.
            level: Level of the test.
            least: Size that the estimate must also exceed.
        """
        if self._deviation is None or not difference > 0.0:
            return None
        count = count_pairs(*self._deviation, difference, level, least)
        return max(fewest_pairs(level), math.ceil(count)) if math.isfinite(count) else None

    def range_needed(self, difference: float, level: float, least: float = 0.0) -> tuple[int, int] | None:
        """Return the numbers of pairs that both ends of the 95 % interval of the scatter need; see `pairs_needed`."""
        if self._deviation is None or not difference > least:
            return None
        low, high = pairs_range(*self._deviation, difference, level, least, CONFIDENCE)
        return max(fewest_pairs(level), math.ceil(low)), max(fewest_pairs(level), math.ceil(high))

    def smallest_shown(self, level: float) -> float | None:
        """Return the difference that as many pairs as these show with a probability of 80 %, see `pairs_needed`."""
        if self._deviation is None or self.n < fewest_pairs(level):
            return None
        return scale(*self._deviation, level) / math.sqrt(self.n - few_pairs(level))

    @property
    def _deviation(self) -> tuple[float, int] | None:
        """Standard deviation of the differences and its degrees of freedom.

        None with fewer than three of them, or if a pair has no number, which leaves the scatter unknown.
        """
        known = self.n >= 3 and not any(self.lost)
        return (float(np.std(self.b - self.a, ddof=1)), self.n - 1) if known else None

    @cached_property
    def _ranks(self) -> SignedRanks:
        return SignedRanks(self.differences)


def fewest_pairs(level: float) -> int:
    """Return the fewest pairs whose smallest p-value, 2 / 2^n, is below a level."""
    return math.floor(1.0 - math.log2(level)) + 1


def compare_paired(a: FloatArray, b: FloatArray) -> PairedComparison:
    """Compare two configs run on the same seeds.

    Args:
        a: Values of the first config, shape (n,), one for each repetition; infinity is beyond every number. Where both
            are, there is no pair. It needs one repetition at least.
        b: Values of the second, in the same order.

    Raises:
        ValueError: If the shapes differ or there is no pair.
    """
    if a.shape != b.shape or a.ndim != 1 or not a.size:
        raise ValueError(f"pairs need two samples of one length, at least 1; found shapes {a.shape} and {b.shape}")
    kept = ~is_empty(a, b)
    empty = int(a.size - kept.sum())
    return PairedComparison(a[kept], b[kept], b[kept] - a[kept], empty=Empty(empty, a.size, int(empty > 0)))


def is_empty(a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
    """Return where both values are beyond every number."""
    return np.isinf(a) & np.isinf(b)


def subtract(b: FloatArray, a: FloatArray) -> FloatArray:
    """Return b - a, zero where both are beyond every number."""
    difference = np.zeros(a.shape)
    unequal = a != b
    difference[unequal] = b[unequal] - a[unequal]
    return difference


def holm(p_values: Sequence[float]) -> FloatArray:
    """Return p-values of a family of tests, corrected so that one or more false rejections have the stated probability.

    The k-th smallest of m, k from 1, is multiplied by m + 1 - k, and is no smaller than those before it, no larger than
    1 (Holm, "A simple sequentially rejective multiple test procedure", Scandinavian J. Statistics 6, 1979). It
    demands nothing of how the tests depend on each other.

    Args:
        p_values: Those of the tests, shape (m,).

    Returns:
        The corrected ones, shape (m,), in the same order.
    """
    given = np.asarray(p_values, dtype=float)
    order = np.argsort(given, kind="stable")
    corrected = np.empty(len(given))
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(given[order] * np.arange(len(given), 0, -1)))
    return corrected


def holm_levels(p_values: Sequence[float], alpha: float) -> FloatArray:
    """Return the level at which Holm's procedure decides each test of a family: it rejects what is below its level.

    The k-th smallest p-value of m is compared with alpha / (m + 1 - k); after the first that is not below, all that
    follow are decided at that same level.

    Args:
        p_values: Those of the tests, shape (m,).
        alpha: Probability of one or more false rejections.
    """
    given = np.asarray(p_values, dtype=float)
    order = np.argsort(given, kind="stable")
    steps = alpha / np.arange(len(given), 0, -1)
    kept = np.flatnonzero(given[order] >= steps)
    levels = np.empty(len(given))
    levels[order] = np.minimum(steps, steps[kept[0]]) if kept.size else steps
    return levels
