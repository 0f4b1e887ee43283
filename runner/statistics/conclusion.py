"""Rule of a conclusion: a difference with its sign, or none.

A difference counts if its p-value, corrected for the family of tests, is below the level, or if nothing is drawn. It
must also exceed the integration error in it and 2 % of the larger of the two medians, or 0.02 of a fraction.
"""

import numpy as np

from runner.base.quantities import ROUNDING
from runner.statistics.paired import PairedComparison

ALPHA = 0.05
"""Probability of one or more false differences in a family of tests."""

SHARE = 0.02
"""Share of the larger median, or a fraction itself, up to which a difference does not count."""


def larger_median(found: PairedComparison) -> float:
    """Return the larger of the two finite medians by its size; 0 if neither is finite."""
    return max((abs(median) for median in found.medians if np.isfinite(median)), default=0.0)


def least_difference(found: PairedComparison, is_fraction: bool = False) -> float:
    """Return the difference from which on it counts, in the unit of the metric.

    Args:
        found: The comparison.
        is_fraction: True for a metric that is a fraction.
    """
    share = SHARE if is_fraction else SHARE * larger_median(found)
    return max(share, ROUNDING, found.error or 0.0)


def conclusion_sign(found: PairedComparison, is_shown: bool, is_fraction: bool = False) -> int:
    """Return -1 where the second may be called smaller, 1 where larger, 0 where neither may be said.

    Args:
        found: The comparison.
        is_shown: True if the corrected p-value is below the level; of no effect on an exact comparison.
        is_fraction: True for a metric that is a fraction.
    """
    holds = (found.exact or is_shown) and abs(found.difference) > least_difference(found, is_fraction)
    return int(np.sign(found.difference)) if holds else 0
