"""Reasons for the early end of a run: divergence, or a control law without a result."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.base.trace import Failure
from runner.robots.model import RobotModel
from runner.simulation.compiled.closed_loop import Signals

# No arm reaches this speed, so a run above it has diverged.
DIVERGED_SPEED = 1e6  # rad/s, or m/s for a prismatic joint


def find_divergence(q: FloatArray, dq: FloatArray, times: FloatArray, model: RobotModel) -> Failure | None:
    """Return the first row with a joint that is not finite or too fast; None if there is none.

    Args:
        q: Joint positions, shape (T, nq), in rad.
        dq: Joint velocities, shape (T, nq), in rad/s.
        times: Time of each row, shape (T,), in s.
        model: The arm, for the names of its joints.
    """
    wild = ~(np.isfinite(q) & (np.abs(dq) < DIVERGED_SPEED))
    if not wild.any():
        return None
    row = int(np.argmax(wild.any(axis=1)))
    joint = int(np.argmax(wild[row]))
    reason = f"diverged: not finite or above {DIVERGED_SPEED:g} {model.joint_units[joint]}/s"
    return Failure(reason, float(times[row]), model.joint_names[joint])


def ended_well(signals: Signals) -> np.ndarray:
    """Return True for each run compiled as a whole that ended without a failure, shape (runs,)."""
    finite = np.isfinite(signals.q).all(axis=(1, 2)) & np.isfinite(signals.torque).all(axis=(1, 2))
    slow = np.abs(signals.dq).max(axis=(1, 2)) < DIVERGED_SPEED
    well: np.ndarray = finite & slow & ~signals.fault.any(axis=1)
    return well


def find_failure(signals: Signals, run: int, times: FloatArray, model: RobotModel) -> Failure | None:
    """Return the failure of one of several runs compiled as a whole; None without a failure.

    Args:
        signals: Signals of the runs.
        run: Index of the run.
        times: Time of each row of the run, shape (T,), in s; it may have fewer rows than the signals.
        model: Model of the arm.
    """
    rows = len(times)
    fault = signals.first_fault(run, times)
    last = rows if fault is None else fault[0] + 1
    diverged = find_divergence(signals.q[run, :last], signals.dq[run, :last], times[:last], model)
    if diverged is not None or fault is None:
        return diverged
    row, error = fault
    return Failure(error.reason if isinstance(error, SimulationError) else str(error), float(times[row]))
