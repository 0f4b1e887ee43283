"""Metrics of runs, and their summary over the repetitions of a run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Trace
from runner.metrics import positioning, tracking
from runner.metrics.family import MetricContext, evaluate_added
from runner.plugins import metric_units

_FAMILIES = metric_units.METRICS.built_in()
MOST_LISTED = 2000
"""Largest number of repetitions whose values a record lists; above it, the record has their quantiles."""

_PERCENT = {"0.01": 1, "0.05": 5, "0.25": 25, "0.75": 75, "0.95": 95, "0.99": 99}  # levels of quantiles
_BLOCK = 80_000  # values of a signal in a block of runs, which fits in the CPU cache


@dataclass(frozen=True)
class Summary:
    """One metric over the repetitions of a job.

    Attributes:
        unit: Unit of the metric.
        values: Value in each repetition, shape (repetitions,); NaN for a missing value (never settled, or the
            repetition failed).
        median: Median, with missing values counted as infinite; None if it is infinite.
        min: Smallest value; None if all values are missing.
        max: Largest value; None if any value is missing.
        quantiles: Quantiles by level, with missing values counted as infinite; empty up to MOST_LISTED repetitions.
    """

    unit: str
    values: FloatArray
    median: float | None
    min: float | None
    max: float | None
    quantiles: Mapping[str, float | None]

    @property
    def listed(self) -> bool:
        """True if the record lists the values."""
        return len(self.values) <= MOST_LISTED

    def record(self) -> dict[str, object]:
        """Return the summary in the form that is stored in a run's record."""
        ends = {"median": self.median, "min": self.min, "max": self.max}
        if self.listed:
            return {"unit": self.unit, "values": [_present(value) for value in self.values.tolist()], **ends}
        return {"unit": self.unit, **ends, "quantiles": dict(self.quantiles)}


def evaluate(trace: Trace, context: MetricContext, notices: list[str] | None = None) -> dict[str, float | None]:
    """Return all metrics of one run; a failed run has none. See `measure` for the built-in ones.

    Args:
        trace: Trace of the run.
        context: Context of the metrics.
        notices: List that receives a message for each fault in user-supplied metrics.

    Raises:
        SimulationError: if user-supplied metrics try to change the trace, or a user-supplied trajectory fails.
    """
    if trace.failure is not None:
        return {}
    told = [] if notices is None else notices
    return of_run(measure(trace[None], context), 0) | evaluate_added(trace, context, told)


def measure(traces: Trace, context: MetricContext) -> dict[str, FloatArray]:
    """Return the built-in metrics of several runs, each of shape (runs,); NaN for a run without a value.

    For a robot with mounted stages, there are also positioning and tracking metrics of each base stage, with its name
    as prefix: `macro_settling_time`. They compare its end point with x_d minus the home offset of the stages mounted on
    it.

    The values of a run do not depend on the other runs, not even by rounding.

    Raises:
        SimulationError: if a user-supplied trajectory fails; `evaluate` of single runs shows which run it is.
    """
    rows, joints = traces.q.shape[1:]
    block = max(1, _BLOCK // (rows * joints))
    parts = [_measure_block(traces[first : first + block], context) for first in range(0, len(traces.q), block)]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _measure_block(traces: Trace, context: MetricContext) -> dict[str, FloatArray]:
    values: dict[str, FloatArray] = {}
    for family in _FAMILIES:
        values |= family.evaluate(traces, context)
    for index, stage in enumerate(traces.stage_names[:-1]):
        stage_context = context.at_stage(traces.offsets[index])
        at_stage = traces.at_stage(index)
        for family in (positioning, tracking):
            of_stage = family.evaluate(at_stage, stage_context)
            values |= {f"{stage}_{name}": value for name, value in of_stage.items()}
    return values


def of_run(measured: Mapping[str, FloatArray], run: int) -> dict[str, float | None]:
    """Return the metrics of one run from the result of `measure`, by the index of the run; None for a missing value."""
    values = {name: float(value[run]) for name, value in measured.items()}
    return {name: _present(value) for name, value in values.items()}


def summarize_arrays(names: tuple[str, ...], values: FloatArray) -> dict[str, Summary]:
    """Return the summaries of metrics, given as an array of shape (repetitions, names) with NaN for missing values."""
    pairs = zip(names, metric_units.units_of(names), values.T, strict=True)
    return {name: _summarize(unit, own) for name, unit, own in pairs}


def _summarize(unit: str, values: FloatArray) -> Summary:
    ordered = _ordered(values)
    quantiles = _quantiles(ordered) if len(values) > MOST_LISTED else {}
    return Summary(unit, values, *_present_ends(ordered), quantiles)


def _present(value: float) -> float | None:
    return None if math.isnan(value) else value


def over_repetitions(values: FloatArray) -> FloatArray:
    """Return median, smallest and largest value over the repetitions, shapes (..., repetitions) to (..., 3).

    A missing value is NaN and counts as infinite; an infinite result is returned as NaN.
    """
    return _ends(_ordered(values))


def _ordered(values: FloatArray) -> FloatArray:
    """Return values over the repetitions in ascending order, with infinity for NaN, shape (..., repetitions)."""
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
    """Return the quantiles by level of ascending values, shape (repetitions,), with infinity for missing values.

    Quantiles between two values are interpolated linearly. An infinite quantile is None.
    """
    found: dict[str, float | None] = {}
    for level, percent in _PERCENT.items():
        place, rest = divmod(percent * (len(ordered) - 1), 100)
        value = float(ordered[place])
        if rest and math.isfinite(value):
            value += rest / 100.0 * (float(ordered[place + 1]) - value)
        found[level] = value if math.isfinite(value) else None
    return found
