"""How close the Mini is to a singular posture, and the sag that keeps it from folding."""

from collections.abc import Callable

import numpy as np

from runner.quantities import number
from runner.reporting.document import FloatArray
from runner.reporting.figures import joint_columns, model_of
from runner.reporting.run_values import clock
from runner.store import Run
from runner.works.thesis.left_out_gravity import missing_acceleration


def singular_value(run: Run) -> FloatArray:
    """Return the smallest singular value of the Mini's Jacobian at each tick, shape (T,), in m."""
    return _singular_values(run)[:, -1]


def volume(run: Run) -> FloatArray:
    """Return the manipulability |det J| of the Mini at each tick, shape (T,), in m^3."""
    return np.asarray(_singular_values(run).prod(axis=1))


def first(signal: Callable[[Run], FloatArray]) -> Callable[[Run], float]:
    """Return the first value of a signal."""
    return lambda run: float(signal(run)[0])


def closest(signal: Callable[[Run], FloatArray]) -> Callable[[Run], float]:
    """Return the value of a signal where the Mini is closest to a singular posture."""
    return lambda run: float(signal(run)[_row(run)])


def volume_of_closest(run: Run) -> str:
    """Return the manipulability there for a table: folded, it is smaller than what is called rounding elsewhere."""
    return number(closest(volume)(run))


def time_of_closest(run: Run) -> str:
    """Return when that is, in s."""
    return f"{clock(run)[_row(run)]:.2f}"


def sag(run: Run) -> float:
    """Return the closed form of the Macro's sag at the end of a run, in m."""
    rate = float(run.config["controller"]["natural_frequency"]["macro"])
    return missing_acceleration(run, len(run.trace) - 1) / rate**2


def _row(run: Run) -> int:
    singular = singular_value(run)
    return int(np.nanargmin(singular)) if np.isfinite(singular).any() else 0


def _singular_values(run: Run) -> FloatArray:
    """Return those of the Mini's columns of the whole arm's Jacobian, shape (T, 3): they depend on no frame."""
    model, positions = model_of(run), joint_columns(run.trace, "q")
    values, finite = np.full((len(positions), 3), np.nan), np.isfinite(positions).all(axis=1)
    jacobians = [model.tip_jacobian(q)[:3, 3:] for q in positions[finite]]
    values[finite] = np.linalg.svd(np.reshape(jacobians, (-1, 3, 3)), compute_uv=False)
    return values
