"""What the studies of the seven joints share."""

import numpy as np

from runner.reporting.document import FloatArray
from runner.reporting.figures import columns, joint_columns, model_of
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.store import Run

SHOULDER = 1  # counted from 0: the joint that lifts the arm


def rate(run: Run) -> str:
    """Return how often a run's law commands, such as "100 Hz"."""
    return f"{1.0 / float(run.config['controller']['period']):g} Hz"


def error_norm(run: Run) -> FloatArray:
    """Return the norm of the tip's error at each tick, shape (T,), in m; NaN where it is zero, for axes of powers."""
    error: FloatArray = np.linalg.norm(columns(run.trace, "error"), axis=1)
    return np.where(error > 0.0, error, np.nan)


def smallest_margin(run: Run) -> str:
    """Return how close a joint comes to a limit of its, in rad, and which joint; below zero is beyond it."""
    margins = _margins(run)
    joint = int(np.argmin(margins))
    return f"{number(float(margins[joint]))} (q{joint + 1})"


def measured_margin(run: Run, name: str) -> Measured:
    """Return how close any joint comes to a limit of its, by a name for conditions."""
    return Measured(name, float(_margins(run).min()), "rad")


def _margins(run: Run) -> FloatArray:
    margins: FloatArray = model_of(run).limit_margins(joint_columns(run.trace, "q")).min(axis=0)
    return margins


def largest_error_at(run: Run) -> float:
    """Return when the largest axis error of the tip is the largest of the run, in s."""
    error = np.abs(columns(run.trace, "error")).max(axis=1)
    return float(run.trace["t"].to_numpy()[int(np.argmax(error))])


def error_at_end(run: Run) -> float:
    """Return the largest axis error of the tip at the end of a run, in m."""
    return float(np.abs(columns(run.trace, "error")[-1]).max())


def first_saturation(run: Run) -> tuple[int, float] | None:
    """Return which joint is the first at its effort limit, counted from 0, and when, in s; None where none is."""
    torques = np.abs(joint_columns(run.trace, "tau"))[:-1]
    at_limit = torques >= model_of(run).effort_limits * (1.0 - 1e-9)
    if not at_limit.any():
        return None
    row, joint = np.argwhere(at_limit)[0]
    return int(joint), float(run.trace["t"].to_numpy()[row])


def clipped(run: Run, joint: int) -> FloatArray:
    """Return the times of the ticks at which a joint, counted from 0, is at its effort limit, in s."""
    torques = np.abs(joint_columns(run.trace, "tau"))[:-1, joint]
    at_limit = torques >= model_of(run).effort_limits[joint] * (1.0 - 1e-9)
    times: FloatArray = run.trace["t"].to_numpy()[:-1][at_limit]
    return times


def clipped_share(run: Run, joint: int, name: str) -> Measured:
    """Return at which share of the ticks a joint is at its effort limit, in per cent, by a name for conditions."""
    ticks = len(run.trace) - 1
    return Measured(name, 100.0 * clipped(run, joint).size / ticks if ticks else None, "%")


def lost_at(run: Run) -> float | None:
    """Return when an axis error of the tip leaves the settling band for the first time, in s; None where none does."""
    beyond = (np.abs(columns(run.trace, "error")) > run.config["robot"]["settling_band"]).any(axis=1)
    return float(run.trace["t"].to_numpy()[int(np.argmax(beyond))]) if beyond.any() else None
