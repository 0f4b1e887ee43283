"""Prediction of torques that a fit has not seen, and the choice of friction and cut-off by it.

A log is cut into stretches; with three or more logs each log is a stretch. Each stretch is predicted by a fit of the
others. At rest friction can be any torque up to its level, so only what exceeds it counts as an error.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.identification.fit import Fit
from runner.identification.friction_kinds import TERMS, friction_at_rest
from runner.identification.log_rows import LogRows
from runner.identification.system import System, linear_system

_STRETCHES = 8  # of a log, or of two logs together
_LOGS = 3  # logs: with these or more, each is a stretch
_APART = 0.2  # s between a held-out stretch and the rows of its fit, which the low-pass mixes
_ROUNDING = 1e-10  # of the largest eigenvalue


@dataclass(frozen=True)
class HeldOut:
    """Errors of prediction.

    Attributes:
        errors: Errors of all rows, shape (R,), in N m; see System.
        stretch: Number of the stretch of each row, shape (R,).
        squares: Mean weighted square of the errors of each stretch, shape (stretches,).
        system: Equations in which they were predicted.
    """

    errors: FloatArray
    stretch: NDArray[np.intp]
    squares: FloatArray
    system: System

    def share(self, joint: int | None = None) -> float:
        """Return the norm of the errors over that of the torques, of a joint or of all."""
        return _share(self.errors, self.system, joint)


def _share(errors: FloatArray, system: System, joint: int | None) -> float:
    own = np.ones(len(errors), dtype=bool) if joint is None else system.joint == joint
    size = float(np.linalg.norm((system.y + system.carried)[own]))
    return float(np.linalg.norm(errors[own])) / size if size > 0.0 else float("nan")


def stretches(system: System) -> NDArray[np.intp]:
    """Return the number of the stretch of each row, shape (R,)."""
    logs = np.unique(system.log)
    if len(logs) >= _LOGS:
        return np.searchsorted(logs, system.log)
    each = _STRETCHES // len(logs)
    found = np.zeros(len(system.log), dtype=np.intp)
    for number, log in enumerate(logs):
        own = system.log == log
        first, last = system.time[own].min(), system.time[own].max()
        share = (system.time[own] - first) / max(last - first, 1e-9)
        found[own] = number * each + np.minimum((share * each).astype(np.intp), each - 1)
    return found


def predict_held_out(fit: Fit, logs: Sequence[LogRows], weights: FloatArray | None = None) -> HeldOut:
    """Return the errors of torques that are predicted from the other stretches.

    Load, delay, v_s and torque constants are those of the fit of all stretches.

    Args:
        fit: The fit of all stretches, at its own cut-off.
        logs: Rows of the same logs in which errors are judged; their cut-off may differ.
        weights: What errors of each joint count in `squares`, shape (nq,); None for those of the fit.
    """
    trained, judged = fit.system, linear_system(logs, fit.state, False)
    columns = [column for column in fit.taken if column < fit.state.layout.constants]
    if weights is None:
        weights = joint_weights(fit)
    used = fit.weights > 0.0
    X, y = trained.X[used][:, columns] * fit.weights[used, None], trained.y[used] * fit.weights[used]
    sizes = np.maximum(np.linalg.norm(X, axis=0), 1e-300)
    X = X / sizes
    whole, right = X.T @ X, X.T @ y
    parts, time, log = stretches(trained)[used], trained.time[used], trained.log[used]
    of_row = stretches(judged)
    errors, squares = np.zeros(len(judged.y)), []
    for stretch in np.unique(of_row):
        own = of_row == stretch
        ends = judged.time[own].min() - _APART, judged.time[own].max() + _APART
        out = (parts == stretch) | ((log == judged.log[own][0]) & (time > ends[0]) & (time < ends[1]))
        G, h = whole - X[out].T @ X[out], right - X[out].T @ y[out]
        scaled = np.zeros(trained.X.shape[1])
        scaled[columns] = np.linalg.lstsq(G, h, rcond=_ROUNDING)[0] / sizes
        errors[own] = _errors(judged, own, scaled)
        squares.append(float(np.mean((errors[own] * weights[judged.joint[own]]) ** 2)))
    return HeldOut(errors, of_row, np.array(squares), judged)


def joint_weights(fit: Fit) -> FloatArray:
    """Return one over the usual residual of each joint, shape (nq,), in 1/(N m); 0 for a joint without rows."""
    weights = np.zeros(fit.state.layout.nq)
    for joint in np.unique(fit.system.joint):
        own = (fit.system.joint == joint) & (fit.weights > 0.0)
        if own.any():
            weights[joint] = float(np.max(fit.weights[own]))
    return weights


def file_share(system: System, base: FloatArray, joint: int | None = None) -> float:
    """Return the norm of what the file's model misses over that of the torques, of a joint or of all.

    Args:
        system: Equations of the rows.
        base: Base parameters of the file, shape (number of sums,).
        joint: The joint; None for all.
    """
    return _share(system.y - system.X[:, : system.layout.base] @ base, system, joint)


def _errors(system: System, rows: NDArray[np.bool_], values: FloatArray) -> FloatArray:
    """Return the errors of values in some rows; at rest only the part that friction does not hold."""
    layout = system.layout
    X, y, joint_of, moving = system.X[rows], system.y[rows], system.joint[rows], system.moving[rows]
    errors: FloatArray = y - X @ values
    for joint in np.unique(joint_of):
        rest = (joint_of == joint) & ~moving
        if not rest.any():
            continue
        place = layout.friction(joint)
        friction = X[rest, place] * values[place]
        terms = TERMS[layout.kind]
        dry = [number for number, term in enumerate(terms) if term not in ("viscous", "offset")]
        away = errors[rest] + friction[:, dry].sum(axis=1)
        load = np.abs(X[rest, : layout.base] @ values[: layout.base] + system.carried[rows][rest])
        level = friction_at_rest(layout.kind, values[place].tolist(), load)
        errors[rest] = np.sign(away) * np.maximum(np.abs(away) - level, 0.0)
    return errors
