"""Medians, table cells, config values and signals of stored runs, including failed runs."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.base.quantities import with_powers
from runner.papers.study.measured import Measured
from runner.reporting.document import Notice, ReportBlock
from runner.reporting.words import in_words
from runner.store import Run


def measured(run: Run, metric: str, name: str) -> Measured:
    """Return the median of a metric as a measured value for the conditions of findings.

    Args:
        run: The run.
        metric: Name of the metric.
        name: What the value is called in conditions.

    Raises:
        RunnerError: if the run has metrics, and none of that name.
    """
    value = run.median(metric)
    return Measured(name, value, run.metrics[metric].unit if run.metrics else "1")


def values(runs: Iterable[Run], metric: str) -> FloatArray:
    """Return the medians of a metric, NaN where there is none."""
    return np.array([np.nan if (m := run.median(metric)) is None else m for run in runs])


def delay_of(run: Run) -> int:
    """Return the delay of the commands of a run's last control loop, without jitter, in ticks of the fastest loop."""
    delay = run.config["plant"].get("computation", {"delay": 0})["delay"]
    return int(list(delay.values())[-1] if isinstance(delay, Mapping) else delay)


def failures(runs: Mapping[str, Run]) -> list[ReportBlock]:
    """Return a notice that names each failed run with its failure; nothing where none failed."""
    reasons: dict[str, list[str]] = {}
    for name, run in runs.items():
        if (failure := run.failure_record) is not None:
            joint = f", {failure['joint']}" if failure["joint"] else ""
            where = f"{in_words(name.partition('/')[2])} (at {failure['time']:.4g} s{joint})"
            reasons.setdefault(with_powers(str(failure["reason"])), []).append(where)
    if not reasons:
        return []
    count = sum(map(len, reasons.values()))
    text = ". ".join(f"{reason}: {'; '.join(names)}" for reason, names in reasons.items())
    return [Notice("failure", f"{count} of {len(runs)} runs failed", f"{text[0].upper()}{text[1:]}.")]


Signal = str | Callable[..., Any]
"""Name of a column of the trace or of a metric, or a function of a run, or of a run and others."""


def trace_of(signal: Signal, *runs: Run) -> FloatArray:
    """Return a signal of a run, or of a run and another, shape (T,).

    Raises:
        RunnerError: if the run has no such column.
    """
    if callable(signal):
        return np.asarray(signal(*runs), dtype=float)
    return runs[0].signal(signal)


def number_of(what: Signal, *runs: Run) -> float | None:
    """Return a number of a run: the median of a metric by its name, or what a function of the run gives; or None."""
    if isinstance(what, str):
        return runs[0].median(what)
    value = what(*runs)
    return value.value if isinstance(value, Measured) else value if value is None else float(value)


def config_value(run: Run, key: str) -> Any:
    """Return a value of a run's config by its dotted key, in which items of lists are counted from 0.

    Raises:
        RunnerError: if there is no such key.
    """
    value: Any = run.config
    for part in key.split("."):
        keys = {str(index): item for index, item in enumerate(value)} if isinstance(value, list) else value
        if not isinstance(keys, Mapping) or part not in keys:
            raise RunnerError(f"no key {key} in a config{nearest(part, keys if isinstance(keys, Mapping) else ())}")
        value = keys[part]
    return value
