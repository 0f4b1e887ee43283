"""What repeated runs allow to be said: intervals, paired comparisons, and which axis of a sweep matters."""

from runner.statistics.effects import PERMUTATIONS, Effect, EffectAnalysis, axis_effects
from runner.statistics.holm import holm
from runner.statistics.interval import SMALLEST_SAMPLE, Interval, median_interval, median_intervals
from runner.statistics.paired import Comparison, compare_paired

__all__ = [
    "PERMUTATIONS",
    "SMALLEST_SAMPLE",
    "Comparison",
    "Effect",
    "EffectAnalysis",
    "Interval",
    "axis_effects",
    "compare_paired",
    "holm",
    "median_interval",
    "median_intervals",
]
