"""What a chapter may draw of a run: signals over time, and numbers of one run or two."""

from collections.abc import Callable, Sequence

import numpy as np

from runner.reporting import run_values
from runner.reporting.document import FloatArray
from runner.reporting.figures import columns, joint_columns, model_of
from runner.reporting.prose.reading import Signal, check_signal, trace_of
from runner.store import Run


def norm(name: str) -> Callable[[Run], FloatArray]:
    """Return the signal |name| of a vector with columns name_x, name_y and name_z."""

    def signal(run: Run) -> FloatArray:
        check_signal(run, f"{name}_x")
        length: FloatArray = np.linalg.norm(columns(run.trace, name), axis=1)
        return length

    return signal


def apart(name: str = "tip") -> Callable[[Run, Run], FloatArray]:
    """Return the distance between such a vector of two runs at their common times."""
    return lambda run, twin: run_values.apart(run, twin, name)


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


def manipulability(run: Run) -> FloatArray:
    """Return sqrt(det(J J^T)) of the tip's position at each row, J in m/rad."""
    return np.array([float(np.prod(values)) for values in _singular(run)])


def smallest_singular_value(run: Run) -> FloatArray:
    """Return the smallest singular value of the tip's position Jacobian at each row, in m/rad."""
    return np.array([float(values[-1]) for values in _singular(run)])


def limit_margin(run: Run) -> FloatArray:
    """Return how far the joint nearest to a limit of its position is from it at each row, in rad or m."""
    margins: FloatArray = model_of(run).limit_margins(joint_columns(run.trace, "q")).min(axis=1)
    return margins


def _singular(run: Run) -> Sequence[FloatArray]:
    model, rows = model_of(run), joint_columns(run.trace, "q")
    return [np.asarray(np.linalg.svd(model.tip_jacobian(q)[:3], compute_uv=False), dtype=float) for q in rows]
