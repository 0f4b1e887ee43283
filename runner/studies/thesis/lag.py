"""Lag of a controller without feedforward, 2 xi / omega_n times the quintic's peak velocity, and its sag."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.figures import AXES, columns
from runner.store import Run
from runner.study.run_values import clock

_REST = 0.5  # s, at the end of a run


def lag(run: Run) -> float:
    """Return the norm of the largest lag, in m."""
    return float(np.linalg.norm(_lag(run)))


def lag_along(axis: str, signed: bool = False) -> Callable[[Run], float]:
    """Return the largest lag along an axis, desired less true position, without its sign unless asked for, in m."""
    along = AXES.index(axis)
    return lambda run: float(_lag(run)[along] if signed else abs(_lag(run)[along]))


def error_in_z_at_rest(run: Run) -> float:
    """Return the mean error in z at the end of a run, in m."""
    at_rest = clock(run) > clock(run)[-1] - _REST
    return float(columns(run.trace, "error")[at_rest].mean(axis=0)[2])


def _lag(run: Run) -> FloatArray:
    """Return the largest lag along each axis, desired less true position, shape (3,), in m."""
    controller, desired = run.config["controller"], columns(run.trace, "desired")
    factor = 2.0 * float(controller["damping_ratio"]) / float(controller["natural_frequency"])
    return np.asarray(factor * 1.875 * (desired[-1] - desired[0]) / float(run.config["trajectory"]["duration"]))
