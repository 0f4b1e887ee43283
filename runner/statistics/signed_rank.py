"""Wilcoxon signed-rank test with the Hodges-Lehmann interval."""

import math
from functools import cached_property, lru_cache

import numpy as np

from runner.base.arrays import FloatArray

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
    """

    def __init__(self, differences: FloatArray) -> None:
        one, other = np.triu_indices(len(differences))
        with np.errstate(invalid="ignore"):
            averages = (differences[one] + differences[other]) / 2
        averages[np.isnan(averages)] = 0.0  # of both infinities
        self._averages = np.sort(averages)
        self._tail = _lower_tail(len(differences))

    @cached_property
    def estimate(self) -> float:
        """The Hodges-Lehmann estimate of the difference: the median of the Walsh averages."""
        middle = self._averages[(len(self._averages) - 1) // 2], self._averages[len(self._averages) // 2]
        return float(middle[0] if middle[0] == middle[1] else sum(middle) / 2)

    @cached_property
    def effect(self) -> float:
        """The matched-pairs rank-biserial correlation: -1 with all differences below zero, 1 with all above."""
        return (self._at_least - self._at_most) / len(self._averages)

    @cached_property
    def p_value(self) -> float:
        """The two-sided p-value: exact up to EXACT_UP_TO differences, of the normal law beyond."""
        fewer = min(self._at_most, self._at_least)
        return min(1.0, 2.0 * float(self._tail[fewer])) if fewer < len(self._tail) else 1.0

    def interval(self, level: float) -> tuple[float, float] | None:
        """Return the interval that misses the difference with at most a given probability; None with too few pairs."""
        k = int(np.searchsorted(2.0 * self._tail, level))
        return (float(self._averages[k - 1]), float(self._averages[-k])) if k else None

    @cached_property
    def _at_most(self) -> int:
        """Number of averages that are not above zero."""
        return int(np.searchsorted(self._averages, 0.0, side="right"))

    @cached_property
    def _at_least(self) -> int:
        """Number of averages that are not below zero."""
        return len(self._averages) - int(np.searchsorted(self._averages, 0.0, side="left"))


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
