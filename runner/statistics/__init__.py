"""What repeated runs allow to be said: intervals, paired comparisons, and which axis of a sweep matters."""

from runner.statistics.effects import Effect, EffectAnalysis, axis_effects
from runner.statistics.interval import SMALLEST_SAMPLE, Interval, median_interval
from runner.statistics.paired import Comparison, compare_paired

__all__ = [
    "SMALLEST_SAMPLE",
    "Comparison",
    "Effect",
    "EffectAnalysis",
    "Interval",
    "axis_effects",
    "compare_paired",
    "median_interval",
]
