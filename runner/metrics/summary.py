"""Metrics of one run, and over its repetitions."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import ModuleType

import numpy as np

from runner.metrics import contact, effort, positioning, reaching, tracking
from runner.metrics.context import MetricContext
from runner.plugins import added
from runner.trace import Trace
from runner.trajectories.shifted import Shifted

_FAMILIES: tuple[ModuleType, ...] = (positioning, tracking, effort, reaching, contact)


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
    return (*_FAMILIES, *(point.load() for point in added("metric")))


def units() -> dict[str, str]:
    """Return the unit of each metric by name, without the suffixes of joints and axes."""
    return {name: unit for family in families() for name, unit in family.UNITS.items()}


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return all metrics of one run; a run that failed has none.

    Where stages ride on each other, the positioning and tracking of a carrier's end point against x_d less the home
    offset of what rides on it stand beside the tip's, with the stage's name in front: `macro_settling_time`.
    """
    if trace.failure is not None:
        return {}
    values = {name: value for family in families() for name, value in family.evaluate(trace, context).items()}
    for index, stage in enumerate(trace.stage_names[:-1]):
        carrier = replace(context, trajectory=Shifted(context.trajectory, trace.offsets[index]))
        for family in (positioning, tracking):
            of_stage = family.evaluate(trace.at_stage(index), carrier)
            values |= {f"{stage}_{name}": value for name, value in of_stage.items()}
    return values


def summarize(repetitions: Sequence[Mapping[str, float | None]]) -> dict[str, Summary]:
    """Summarize the metrics of a job's repetitions, given in order."""
    names = list(dict.fromkeys(name for values in repetitions for name in values))
    known = units()
    summaries = {}
    for name in names:
        values = [values.get(name) for values in repetitions]
        numbers = [math.inf if value is None else value for value in values]
        unit = known[_base(name, known)]
        median, low, high = float(np.median(numbers)), min(numbers), max(numbers)
        summaries[name] = Summary(unit, values, *(x if math.isfinite(x) else None for x in (median, low, high)))
    return summaries


def unit_of(name: str) -> str | None:
    """Return the unit of a metric, whose name may carry a stage in front and a joint or axis behind; None for none."""
    known = units()
    return known.get(_base(name, known))


def _base(name: str, known: Iterable[str]) -> str:
    """Return the metric that a name is of: the longest known one within it; the name itself where there is none."""
    return max((base for base in known if f"_{base}_" in f"_{name}_"), key=len, default=name)
