"""Metrics of one run, and over its repetitions."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import entry_points
from types import ModuleType

import numpy as np

from runner.metrics import effort, positioning, tracking
from runner.metrics.context import MetricContext
from runner.trace import Trace

_FAMILIES: tuple[ModuleType, ...] = (positioning, tracking, effort)


@dataclass(frozen=True)
class Summary:
    """One metric over the repetitions of a job.

    Attributes:
        unit: Its unit.
        values: Its value in each repetition; None where it has none (never settled, or the repetition failed).
        median: Median, a missing value counting as beyond every number; None when that is missing.
        min: Smallest value, None when there is none.
        max: Largest value, None as soon as one is missing.
    """

    unit: str
    values: Sequence[float | None]
    median: float | None
    min: float | None
    max: float | None


def families() -> tuple[ModuleType, ...]:
    """Return the metric families, those of other packages (entry points in `runner.metric`) included."""
    return (*_FAMILIES, *(point.load() for point in entry_points(group="runner.metric")))


def units() -> dict[str, str]:
    """Return the unit of each metric by name, without the suffixes of joints and axes."""
    return {name: unit for family in families() for name, unit in family.UNITS.items()}


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return all metrics of one run; a run that failed has none."""
    if trace.failure is not None:
        return {}
    return {name: value for family in families() for name, value in family.evaluate(trace, context).items()}


def summarize(repetitions: Sequence[Mapping[str, float | None]]) -> dict[str, Summary]:
    """Summarize the metrics of a job's repetitions, given in order."""
    names = list(dict.fromkeys(name for values in repetitions for name in values))
    known = units()
    summaries = {}
    for name in names:
        values = [values.get(name) for values in repetitions]
        numbers = [math.inf if value is None else value for value in values]
        unit = next(unit for base, unit in known.items() if name == base or name.startswith(f"{base}_"))
        median, low, high = float(np.median(numbers)), min(numbers), max(numbers)
        summaries[name] = Summary(unit, values, *(x if math.isfinite(x) else None for x in (median, low, high)))
    return summaries
