"""Paired comparison of two configs on the same seeds."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from statistics import NormalDist

import numpy as np

from runner.base.arrays import FloatArray
from runner.statistics.interval import SMALLEST_SAMPLE
from runner.statistics.signed_rank import SignedRanks

_POWER = 0.8  # probability of showing a difference, for which pairs are counted
_EFFICIENCY = 3.0 / math.pi  # of signed ranks, for normal differences, beside the mean


@dataclass(frozen=True, eq=False)
class Comparison:
    """How b differs from a on the same seeds.

    Attributes:
        a: Values of the first, one for each pair, shape (n,); infinity is beyond every number.
        b: Values of the second, in the same order.
        differences: b - a; zero where both are beyond every number.
        error: Typical error of the plants in one difference; None where it is not known.
    """

    a: FloatArray = field(repr=False)
    b: FloatArray = field(repr=False)
    differences: FloatArray = field(repr=False)
    error: float | None = None

    @property
    def n(self) -> int:
        """Number of pairs."""
        return len(self.differences)

    @property
    def medians(self) -> tuple[float, float]:
        """Medians of both."""
        return float(np.median(self.a)), float(np.median(self.b))

    @property
    def lost(self) -> tuple[int, int]:
        """Number of pairs in which a, and in which b, is beyond every number."""
        return int(np.isinf(self.a).sum()), int(np.isinf(self.b).sum())

    @property
    def difference(self) -> float:
        """The Hodges-Lehmann estimate of b - a."""
        return self._ranks.estimate

    @property
    def effect(self) -> float:
        """Matched-pairs rank-biserial correlation, -1 (b smaller in every pair) to 1 (b larger in every pair)."""
        return self._ranks.effect

    @property
    def p_value(self) -> float | None:
        """Two-sided p of the signed-rank test, alone; None with fewer than SMALLEST_SAMPLE pairs."""
        return self._ranks.p_value if self.n >= SMALLEST_SAMPLE else None

    def interval(self, level: float) -> tuple[float, float] | None:
        """Return the interval of the same test: it excludes zero exactly if p is below the level.

        None with too few pairs for that level.
        """
        return self._ranks.interval(level) if self.n >= SMALLEST_SAMPLE else None

    @property
    def correlation(self) -> float | None:
        """Correlation of a and b over the pairs with two numbers; None where one of them does not vary."""
        one, other = self._numbers
        return float(np.corrcoef(one, other)[0, 1]) if len(one) > 2 and one.std() > 0.0 < other.std() else None

    def pairs_needed(self, difference: float, level: float) -> int | None:
        """Return how many pairs show a difference with a probability of 80 %; None if these pairs do not tell.

        With s_a and s_b the standard deviations of both and r their correlation, the variance of a difference is
        s_a^2 + s_b^2 - 2 r s_a s_b. It is taken to be normal.

        Args:
            difference: The difference.
            level: Level of the test.
        """
        one, other = self._numbers
        if len(one) < 3 or not difference > 0.0:
            return None
        covariance = np.cov(one, other)
        variance = max(0.0, float(covariance[0, 0] + covariance[1, 1] - 2.0 * covariance[0, 1]))
        normal = NormalDist()
        quantiles = normal.inv_cdf(1.0 - level / 2.0) + normal.inv_cdf(_POWER)
        count = quantiles**2 * variance / difference**2 / _EFFICIENCY
        return max(fewest_pairs(level), math.ceil(count)) if math.isfinite(count) else None

    @property
    def _numbers(self) -> tuple[FloatArray, FloatArray]:
        both = np.isfinite(self.a) & np.isfinite(self.b)
        return self.a[both], self.b[both]

    @cached_property
    def _ranks(self) -> SignedRanks:
        return SignedRanks(self.differences)


def fewest_pairs(level: float) -> int:
    """Return the fewest pairs of which the smallest p-value, 2 / 2^n, is below a level."""
    return math.floor(1.0 - math.log2(level)) + 1


def compare_paired(a: FloatArray, b: FloatArray) -> Comparison:
    """Compare two configs run on the same seeds.

    Args:
        a: Values of the first config, shape (n,), one for each repetition; infinity is beyond every number, and two
            of these are equal. It needs one pair at least.
        b: Values of the second, in the same order.

    Raises:
        ValueError: If the shapes differ or there is no pair.
    """
    if a.shape != b.shape or a.ndim != 1 or not a.size:
        raise ValueError(f"pairs need two samples of one length, at least 1; found shapes {a.shape} and {b.shape}")
    return Comparison(a, b, subtract(b, a))


def subtract(b: FloatArray, a: FloatArray) -> FloatArray:
    """Return b - a, zero where both are beyond every number."""
    difference = np.zeros(a.shape)
    unequal = a != b
    difference[unequal] = b[unequal] - a[unequal]
    return difference
