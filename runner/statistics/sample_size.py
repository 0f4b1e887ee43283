"""Number of pairs that show a difference, counted from the scatter of some pairs.

The scatter of few pairs is itself uncertain. Therefore the number is chosen so that the probability of showing the
difference, averaged over such pairs, is POWER (Julious and Owen, "Sample size calculations for clinical studies
allowing for uncertainty about the variance", Pharmaceutical Statistics 5, 2006). It follows from a quantile of the
noncentral t distribution.
"""

import math
from statistics import NormalDist

POWER = 0.8
"""Probability of showing a difference, averaged over the pairs that it is counted from."""

_EFFICIENCY = 3.0 / math.pi  # of signed ranks, for normal differences, relative to the mean
_NORMAL = NormalDist()


def count_pairs(deviation: float, freedom: int, difference: float, level: float, least: float = 0.0) -> float:
    """Return the number of pairs that show a difference, not rounded; infinite if no number does.

    Args:
        deviation: Standard deviation of the differences of some pairs.
        freedom: Its degrees of freedom, two or more.
        difference: The difference, above zero.
        level: Level of the two-sided test.
        least: Size that the estimated difference must also exceed.
    """
    if difference <= least:
        return math.inf
    tested = (scale(deviation, freedom, level) / difference) ** 2 + few_pairs(level)
    exceeded = (_scale(deviation, freedom, 0.0) / (difference - least)) ** 2
    return max(tested, exceeded)


def pairs_range(
    deviation: float, freedom: int, difference: float, level: float, least: float, share: float
) -> tuple[float, float]:
    """Return the numbers of pairs that the two ends of an interval of the true scatter need; see `count_pairs`.

    Args:
        deviation: Standard deviation of the differences of some pairs.
        freedom: Its degrees of freedom.
        difference: The difference, above `least`.
        level: Level of the two-sided test.
        least: Size that the estimated difference must also exceed.
        share: Probability of the interval.
    """
    from scipy.special import chdtri

    power = _NORMAL.inv_cdf(POWER)
    tested, exceeded = (_quantile(level) + power) / difference, power / (difference - least)
    tails = (1.0 - share) / 2.0, (1.0 + share) / 2.0
    low, high = (deviation**2 / _EFFICIENCY * freedom / float(chdtri(freedom, tail)) for tail in tails)
    return (
        max(tested**2 * low + few_pairs(level), exceeded**2 * low),
        max(tested**2 * high + few_pairs(level), exceeded**2 * high),
    )


def scale(deviation: float, freedom: int, level: float) -> float:
    """Return the difference that one pair shows, without the correction of `few_pairs`."""
    return _scale(deviation, freedom, _quantile(level))


def few_pairs(level: float) -> float:
    """Return the pairs that a test of few needs in addition (Guenther, The American Statistician 35, 1981)."""
    return _quantile(level) ** 2 / 2.0


def _quantile(level: float) -> float:
    return _NORMAL.inv_cdf(1.0 - level / 2.0)


def _scale(deviation: float, freedom: int, noncentrality: float) -> float:
    """Return the deviation times the quantile of the noncentral t distribution at POWER.

    Its approximation by a normal law (Abramowitz and Stegun, 26.7.10) is within 1 % from six degrees of freedom on.
    """
    a, b = 1.0 - 1.0 / (4.0 * freedom), _NORMAL.inv_cdf(POWER) ** 2
    c = a * a - b / (2.0 * freedom)
    root = math.sqrt(a * a * noncentrality**2 - c * (noncentrality**2 - b))
    return (a * noncentrality + root) / c * deviation / math.sqrt(_EFFICIENCY)
