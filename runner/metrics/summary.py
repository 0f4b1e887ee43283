"""Metrics of runs, and their summary over the repetitions of a run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import import_module

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Trace, Traces
from runner.metrics import positioning, tracking
from runner.metrics.family import MetricContext, OwnFamily, evaluate_added
from runner.plugins import metric_units
from runner.trajectories.shaped import Shifted

_FAMILIES: list[OwnFamily] = [import_module(name) for name in metric_units.FAMILIES]
MOST_LISTED = 2000
"""Repetitions up to which a record lists a metric's values; above it has their quantiles, and they stand beside it."""

_PERCENT = {"0.01": 1, "0.05": 5, "0.25": 25, "0.75": 75, "0.95": 95, "0.99": 99}  # levels of quantiles
_BLOCK = 80_000  # values of a signal, of as many runs as give so many at a time: what caches hold


@dataclass(frozen=True)
class Summary:
    """One metric over the repetitions of a job.

    Attributes:
        unit: Its unit.
        values: Its value in each repetition, shape (repetitions,); NaN where it has none (never settled, or the
            repetition failed).
        median: Median, a missing value counting as beyond every number; None when that is missing.
        min: Smallest value, None when there is none.
        max: Largest value, None as soon as one is missing.
        quantiles: Of more than MOST_LISTED repetitions: quantiles by level, a missing value counting likewise.
    """

    unit: str
    values: FloatArray
    median: float | None
    min: float | None
    max: float | None
    quantiles: Mapping[str, float | None]

    @property
    def listed(self) -> bool:
        """Whether its record lists the values."""
        return len(self.values) <= MOST_LISTED

    def record(self) -> dict[str, object]:
        """Return what is stored of it in a run's record."""
        ends = {"median": self.median, "min": self.min, "max": self.max}
        if self.listed:
            return {"unit": self.unit, "values": [_present(value) for value in self.values.tolist()], **ends}
        return {"unit": self.unit, **ends, "quantiles": dict(self.quantiles)}


def evaluate(trace: Trace, context: MetricContext, notices: list[str] | None = None) -> dict[str, float | None]:
    """Return all metrics of one run; a run that failed has none. See `measure` for ours.

    Args:
        trace: The run's trace.
        context: Its setting.
        notices: Takes a message for each fault in user-supplied metrics.

    Raises:
        SimulationError: if user-supplied metrics try to change the trace, or a user-supplied trajectory fails.
    """
    if trace.failure is not None:
        return {}
    told = [] if notices is None else notices
    return of_run(measure(Traces.of(trace), context), 0) | evaluate_added(trace, context, told)


def measure(traces: Traces, context: MetricContext) -> dict[str, FloatArray]:
    """Return our metrics of several runs, each of shape (runs,), NaN where a run has no value.

    Where stages ride on each other, the positioning and tracking of a carrier's end point against x_d less the home
    offset of what rides on it stand beside the tip's, with the stage's name in front: `macro_settling_time`.

    A run's values are the same to the last bit in whatever company.

    Raises:
        SimulationError: where a trajectory of the user's goes wrong; which run that was tells `evaluate`.
    """
    rows, joints = traces.q.shape[1:]
    block = max(1, _BLOCK // (rows * joints))
    parts = [
        _measure_block(traces.part(slice(first, first + block)), context) for first in range(0, traces.runs, block)
    ]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _measure_block(traces: Traces, context: MetricContext) -> dict[str, FloatArray]:
    values: dict[str, FloatArray] = {}
    for family in _FAMILIES:
        values |= family.evaluate(traces, context)
    for index, stage in enumerate(traces.stage_names[:-1]):
        stage_context = replace(context, trajectory=Shifted(context.trajectory, traces.offsets[index]))
        at_stage = traces.at_stage(index)
        for family in (positioning, tracking):
            of_stage = family.evaluate(at_stage, stage_context)
            values |= {f"{stage}_{name}": value for name, value in of_stage.items()}
    return values


def of_run(measured: Mapping[str, FloatArray], run: int) -> dict[str, float | None]:
    """Return the metrics of one of the runs that `measure` has measured, by its number; None for no value."""
    values = {name: float(value[run]) for name, value in measured.items()}
    return {name: _present(value) for name, value in values.items()}


def summarize_arrays(names: tuple[str, ...], values: FloatArray) -> dict[str, Summary]:
    """Summarize the metrics of a job's repetitions, given as an array of shape (repetitions, names), NaN for none."""
    pairs = zip(names, metric_units.units_of(names), values.T, strict=True)
    return {name: _summarize(unit, own) for name, unit, own in pairs}


def _summarize(unit: str, values: FloatArray) -> Summary:
    """Summarize one metric, shape (repetitions,)."""
    ordered = _ordered(values)
    quantiles = _quantiles(ordered) if len(values) > MOST_LISTED else {}
    return Summary(unit, values, *_present_ends(ordered), quantiles)


def _present(value: float) -> float | None:
    return None if math.isnan(value) else value


def over_repetitions(values: FloatArray) -> FloatArray:
    """Return median, smallest and largest over the repetitions, shapes (..., repetitions) to (..., 3).

    A missing value is NaN, and counts as beyond every number; what is beyond every number is NaN.
    """
    return _ends(_ordered(values))


def _ordered(values: FloatArray) -> FloatArray:
    """Return values over the repetitions in ascending order, a missing one infinite, shape (..., repetitions)."""
    ordered: FloatArray = np.sort(np.where(np.isnan(values), np.inf, values), axis=-1)
    return ordered


def _ends(ordered: FloatArray) -> FloatArray:
    half = ordered.shape[-1] // 2
    middle = ordered[..., half] if ordered.shape[-1] % 2 else (ordered[..., half - 1] + ordered[..., half]) / 2.0
    ends = np.stack([middle, ordered[..., 0], ordered[..., -1]], axis=-1)
    return np.where(np.isfinite(ends), ends, np.nan)


def _present_ends(ordered: FloatArray) -> tuple[float | None, float | None, float | None]:
    middle, low, high = map(_present, _ends(ordered).tolist())
    return middle, low, high


def _quantiles(ordered: FloatArray) -> dict[str, float | None]:
    """Return quantiles by level of values in ascending order, infinite where missing, shape (repetitions,).

    Between two values they are interpolated linearly; None for what is beyond every number.
    """
    found: dict[str, float | None] = {}
    for level, percent in _PERCENT.items():
        place, rest = divmod(percent * (len(ordered) - 1), 100)
        value = float(ordered[place])
        if rest and math.isfinite(value):
            value += rest / 100.0 * (float(ordered[place + 1]) - value)
        found[level] = value if math.isfinite(value) else None
    return found
