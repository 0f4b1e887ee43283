"""Residual coupling in the limit of a massless Mini: the inertial force of its base, per mass.

Two runs of one Mini are compared, the coupled arm and the decoupled one, with equal point masses.
"""

from collections.abc import Callable, Mapping

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.store import Run

_MINI = slice(3, 6)
_JOINTS = {"macro": slice(0, 3), "mini": _MINI}


def difference(arm: str, signal: str) -> Callable[[Run, Run], FloatArray]:
    """Return the difference of a signal, q or tau, of the three joints of the macro or the mini, shape (T, 3)."""
    return lambda coupled, decoupled: _difference(coupled, decoupled, signal)[:, _JOINTS[arm]]


def per_mass(signal: Callable[[Run, Run], FloatArray]) -> Callable[[Run, Run], FloatArray]:
    """Return a signal of two runs over the mass of each of the Mini's two point masses, in kg."""
    return lambda coupled, decoupled: signal(coupled, decoupled) / _mass(coupled)


def felt_most(runs: Mapping[str, Run], pair: str) -> int:
    """Return the joint of the Mini whose averaged torque differs most, counted through the whole arm from 1."""
    return 4 + _most(_simulated(runs[f"{pair}/coupled"], runs[f"{pair}/decoupled"]))


def simulated(coupled: Run, decoupled: Run) -> FloatArray:
    """Return the difference of that joint's torque per mass, averaged over a Macro period, shape (T,), in N m/kg."""
    torques = _simulated(coupled, decoupled)
    return torques[:, _most(torques)]


def inertial(coupled: Run, decoupled: Run) -> FloatArray:
    """Return what the coupled arm's motion asks of that joint beyond what it would on a base at rest, likewise."""
    return _averaged(coupled, _inertial_torque(coupled))[:, _most(_simulated(coupled, decoupled))]


def unexplained(coupled: Run, decoupled: Run) -> FloatArray:
    """Return how far the two are apart at all joints of the Mini, shape (T, 3), in N m/kg."""
    predicted = _averaged(coupled, _inertial_torque(coupled))
    measured = _simulated(coupled, decoupled)[: len(predicted)]
    return measured - predicted[: len(measured)]


def _simulated(coupled: Run, decoupled: Run) -> FloatArray:
    return _averaged(coupled, _difference(coupled, decoupled, "tau")[:, _MINI])


def _most(torques: FloatArray) -> int:
    return int(np.argmax(np.nan_to_num(np.abs(torques)).max(axis=0)))


def _mass(run: Run) -> float:
    return float(run.config["robot"]["stages"]["mini"]["masses"]["link2"])


def _averaged(run: Run, torques: FloatArray) -> FloatArray:
    """Return the mean of each column over a Macro period around each row, per mass; NaN at both ends."""
    period = run.config["controller"]["period"]
    ticks = max(1, round(float(period["macro"]) / float(period["mini"])))
    averaged = np.full(torques.shape, np.nan)
    if len(torques) >= ticks:
        rows = slice(ticks // 2, ticks // 2 + len(torques) - ticks + 1)
        weights = np.full(ticks, 1.0 / ticks / _mass(run))
        averaged[rows] = np.array([np.convolve(column, weights, "valid") for column in torques.T]).T
    return averaged


def _difference(first: Run, second: Run, signal: str) -> FloatArray:
    rows = min(len(first.t), len(second.t))
    return first.joints(signal)[:rows] - second.joints(signal)[:rows]


def _inertial_torque(run: Run) -> FloatArray:
    """Return the torque that a run's motion asks for beyond what it would on a base that only turns gravity.

    It is the inverse dynamics of the whole arm less that of the Mini on a resting base at the same wrist, where the
    Macro's joints neither move nor accelerate; shape (T, 3), in N m.
    """
    model = run.model.pin_model
    data = model.createData()
    q, dq = run.joints("q"), run.joints("dq")
    tick = float(np.diff(run.t).min()) if len(q) > 1 else 1.0
    ddq = np.diff(dq, axis=0) / tick  # torques are held, so this is the mean over the tick
    result = np.zeros_like(ddq)
    resting = np.concatenate([np.zeros(3), np.ones(3)])
    middle, speed = 0.5 * (q[1:] + q[:-1]), 0.5 * (dq[1:] + dq[:-1])
    for row, position, velocity, acceleration in zip(result, middle, speed, ddq, strict=True):
        whole = pin.rnea(model, data, position, velocity, acceleration).copy()
        row[:] = whole - pin.rnea(model, data, position, velocity * resting, acceleration * resting)
    return result[:, _MINI]
