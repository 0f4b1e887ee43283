"""Statistics of repeated runs: confidence intervals, paired comparisons, and effects of sweep axes."""

from runner.statistics.effects import Effect, EffectAnalysis, axis_effects
from runner.statistics.interval import SMALLEST_SAMPLE, Interval, median_interval, median_intervals
from runner.statistics.paired import (
    Empty,
    PairedComparison,
    compare_paired,
    fewest_pairs,
    holm,
    holm_levels,
    is_empty,
    subtract,
)

__all__ = [
    "SMALLEST_SAMPLE",
    "Effect",
    "EffectAnalysis",
    "Empty",
    "Interval",
    "PairedComparison",
    "axis_effects",
    "compare_paired",
    "fewest_pairs",
    "holm",
    "holm_levels",
    "is_empty",
    "median_interval",
    "median_intervals",
    "subtract",
]
