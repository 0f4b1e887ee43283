"""Metrics of one run, and over its repetitions."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median

from runner.errors import ConfigError
from runner.guard import watch_metrics
from runner.metrics import contact, effort, positioning, reaching, tracking
from runner.metrics.context import MetricContext
from runner.metrics.family import MetricFamily
from runner.plugins import added, load
from runner.trace import Trace
from runner.trajectories.shifted import Shifted

_FAMILIES: tuple[MetricFamily, ...] = (positioning, tracking, effort, reaching, contact)


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


def families() -> tuple[MetricFamily, ...]:
    """Return the metric families, those of the user's included.

    Raises:
        ConfigError: where one of these cannot be imported, or has no UNITS or `evaluate`.
    """
    return (*_FAMILIES, *(_load_family(point.name, point.value) for point in added("metric")))


def _load_family(name: str, place: str) -> MetricFamily:
    module = load("metric", name, place)
    if not (isinstance(module, MetricFamily) and isinstance(module.UNITS, Mapping) and callable(module.evaluate)):
        raise ConfigError([f"metric {name}: module {place} needs UNITS, a unit for each name, and evaluate"])
    return module


def units() -> dict[str, str]:
    """Return the unit of each metric by name, without the suffixes of joints and axes."""
    return {name: unit for family in families() for name, unit in family.UNITS.items()}


def evaluate(trace: Trace, context: MetricContext, notices: list[str] | None = None) -> dict[str, float | None]:
    """Return all metrics of one run; a run that failed has none.

    Where stages ride on each other, the positioning and tracking of a carrier's end point against x_d less the home
    offset of what rides on it stand beside the tip's, with the stage's name in front: `macro_settling_time`.

    Args:
        trace: The run's trace.
        context: Its setting.
        notices: Takes what went wrong in metrics of the user's, a text for each.

    Raises:
        SimulationError: where metrics of the user's try to change the trace, or a trajectory of the user's goes wrong.
    """
    if trace.failure is not None:
        return {}
    told = [] if notices is None else notices
    values: dict[str, float | None] = {}
    for family in families():
        ours = family in _FAMILIES
        values |= family.evaluate(trace, context) if ours else watch_metrics(family, trace, context, told)
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
        middle, low, high = median(numbers), min(numbers), max(numbers)
        summaries[name] = Summary(unit, values, *(x if math.isfinite(x) else None for x in (middle, low, high)))
    return summaries


def unit_of(name: str) -> str | None:
    """Return the unit of a metric, whose name may carry a stage in front and a joint or axis behind; None for none."""
    known = units()
    return known.get(_base(name, known))


def _base(name: str, known: Iterable[str]) -> str:
    """Return the metric that a name is of: the longest known one within it; the name itself where there is none."""
    return max((base for base in known if f"_{base}_" in f"_{name}_"), key=len, default=name)
