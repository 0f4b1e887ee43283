"""Signals and numbers of stored runs, by name or by a function."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.store import Run
from runner.study import run_values
from runner.study.measured import Measured
from runner.study.run_values import clock

Signal = str | Callable[..., Any]
"""Name of a column of the trace or of a metric, or a function of a run, or of a run and others."""


def trace_of(signal: Signal, *runs: Run) -> FloatArray:
    """Return a signal of a run, or of a run and another, shape (T,).

    Raises:
        RunnerError: if the run has no such column.
    """
    if callable(signal):
        return np.asarray(signal(*runs), dtype=float)
    check_signal(runs[0], signal)
    return np.asarray(runs[0].trace[signal].to_numpy(), dtype=float)


def times_of(run: Run, rows: int) -> FloatArray:
    """Return the first times of a run's rows, in s."""
    return clock(run)[:rows]


def number_of(what: Signal, *runs: Run) -> float | None:
    """Return a number of a run: the median of a metric by its name, or what a function of the run gives; or None."""
    if isinstance(what, str):
        return run_values.median(runs[0], what)
    value = what(*runs)
    return value.value if isinstance(value, Measured) else value if value is None else float(value)


def config_value(run: Run, key: str) -> Any:
    """Return a value of a run's config by its dotted key.

    Raises:
        RunnerError: if there is no such key.
    """
    value: Any = run.config
    for part in key.split("."):
        if not isinstance(value, Mapping) or part not in value:
            raise RunnerError(f"no key {key} in a config{nearest(part, value if isinstance(value, Mapping) else ())}")
        value = value[part]
    return value


def check_signal(run: Run, column: str) -> None:
    """Refuse a signal that a run does not have.

    Raises:
        RunnerError: if its trace has no such column.
    """
    if column not in run.trace.columns:
        near = nearest(column, [str(name) for name in run.trace.columns])
        raise RunnerError(f"run {run.hash} has no signal '{column}'{near}")
