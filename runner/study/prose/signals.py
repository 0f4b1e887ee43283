"""Signals over time, and numbers of one or two runs, for chapters."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.figures import columns, joint_columns, model_of
from runner.store import Run
from runner.study import run_values
from runner.study.run_values import Signal, check_signal, config_value, trace_of


def norm(name: str) -> Callable[[Run], FloatArray]:
    """Return the signal |name| of a vector with columns name_x, name_y and name_z."""

    def signal(run: Run) -> FloatArray:
        check_signal(run, f"{name}_x")
        return np.asarray(np.linalg.norm(columns(run.trace(), name), axis=1))

    return signal


def distance(name: str = "tip") -> Callable[[Run, Run], FloatArray]:
    """Return the distance between such a vector of two runs at their common times."""
    return lambda run, twin: run_values.distance(run, twin, name)


def moved(name: str) -> Callable[[Run], FloatArray]:
    """Return how far a column is from its first value."""
    return lambda run: trace_of(name, run) - trace_of(name, run)[0]


def at_the_end(signal: Signal) -> Callable[..., float]:
    """Return the last value of a signal."""
    return lambda *runs: float(trace_of(signal, *runs)[-1])


def largest_of(signal: Signal) -> Callable[..., float | None]:
    """Return the largest finite value of a signal, without sign; None where there is none."""

    def value(*runs: Run) -> float | None:
        given = np.abs(trace_of(signal, *runs))
        finite = given[np.isfinite(given)]
        return float(finite.max()) if finite.size else None

    return value


def scaled(factor: float, what: Callable[..., float]) -> Callable[..., float]:
    """Return so many times a number, such as 1000 for mm."""
    return lambda *runs: factor * what(*runs)


def part(what: Callable[..., Mapping[str, Any]], key: str, factor: float = 1.0) -> Callable[..., Any]:
    """Return so many times one of the numbers that a function gives, or one of its texts, by its key."""

    def value(*runs: Run) -> Any:
        own = what(*runs)[key]
        return own if factor == 1.0 else factor * own

    return value


def setting(key: str, factor: float = 1.0) -> Callable[[Run], float]:
    """Return so many times the number that stands in a run's config under a dotted key."""
    return lambda run: factor * float(config_value(run, key))


def manipulability(run: Run) -> FloatArray:
    """Return sqrt(det(J J^T)) at each row, of the tip's position, in m³, or of its pose where the law leads that."""
    return np.array([float(np.prod(values)) for values in _singular(run)])


def smallest_singular_value(run: Run) -> FloatArray:
    """Return the smallest singular value of the same Jacobian at each row, in m/rad for a position."""
    return np.array([float(values[-1]) for values in _singular(run)])


def limit_margin(run: Run) -> FloatArray:
    """Return how far the joint nearest to a limit of its position is from it at each row, in rad or m."""
    return np.asarray(model_of(run).limit_margins(joint_columns(run.trace(), "q")).min(axis=1))


def _singular(run: Run) -> Sequence[FloatArray]:
    model, rows = model_of(run), 6 if run.config["controller"].get("task") == "pose" else 3
    q = joint_columns(run.trace(), "q")
    return [np.asarray(np.linalg.svd(model.tip_jacobian(row)[:rows], compute_uv=False), dtype=float) for row in q]
