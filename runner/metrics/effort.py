"""Effort metrics: torque, speed, saturation, energy and control effort."""

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.trace import Trace, by_rows
from runner.metrics.family import MetricContext

_AT_LIMIT = 1.0 - 1e-12

UNITS = {
    "peak_torque": "N m",
    "rms_torque": "N m",
    "torque_chatter": "N m",
    "peak_joint_speed": "rad/s",
    "peak_joint_force": "N",
    "rms_joint_force": "N",
    "force_chatter": "N",
    "peak_sliding_speed": "m/s",
    "saturation_fraction": "1",
    "energy": "J",
    "control_effort": "N^2 m^2 s",
    "force_effort": "N^2 s",
}


def evaluate(traces: Trace, context: MetricContext) -> dict[str, FloatArray]:
    """Return torques, speeds, saturation, energy and effort, from the applied torques (all rows except the last).

    - peak_torque: largest absolute torque of the revolute joints; also for each joint, as in peak_torque_q1.
    - rms_torque: RMS torque of the revolute joints; also for each joint.
    - torque_chatter: RMS change of the torque of the revolute joints from one tick to the next; also for each joint.
    - peak_joint_speed: largest absolute speed of the revolute joints; also for each joint.
    - peak_joint_force: largest absolute force of the prismatic joints; also for each joint.
    - rms_joint_force: RMS force of the prismatic joints; also for each joint.
    - force_chatter: RMS change of the force of the prismatic joints from one tick to the next; also for each joint.
    - peak_sliding_speed: largest absolute speed of the prismatic joints; also for each joint.
    - saturation_fraction: fraction of ticks with at least one joint at its limit; also for each joint.
    - energy: integral of sum |tau dq|; exact if no joint reverses within a tick, because the torque is constant there.
    - control_effort: integral of sum tau^2; over the revolute joints.
    - force_effort: integral of the sum of squared forces; over the prismatic joints.
    """
    held, ticks = by_rows(traces.tau[:, :-1]), traces.tau.shape[1] - 1
    squares, size = (held * held).sum(axis=2), np.abs(held)
    peaks, speeds = size.max(axis=2), np.abs(by_rows(traces.dq)).max(axis=2)
    work = np.abs(held * np.diff(by_rows(traces.q), axis=2)).sum(axis=2)
    steps = _squared_steps(held)
    prismatic = np.array([unit == "m" for unit in traces.joint_units])
    result: dict[str, FloatArray] = {}
    for peak, rms, chatter, fastest, chosen in (
        ("peak_torque", "rms_torque", "torque_chatter", "peak_joint_speed", ~prismatic),
        ("peak_joint_force", "rms_joint_force", "force_chatter", "peak_sliding_speed", prismatic),
    ):
        joints = np.flatnonzero(chosen)
        if len(joints):
            result |= _over_joints(peak, peaks.max(axis=1, where=chosen, initial=0.0), peaks, joints)
            for name, totals, count in ((rms, squares, ticks), (chatter, steps, max(ticks - 1, 1))):
                overall = np.sqrt(_over(totals, joints) / (count * len(joints)))
                result |= _over_joints(name, overall, np.sqrt(totals / count), joints)
            result |= _over_joints(fastest, speeds.max(axis=1, where=chosen, initial=0.0), speeds, joints)
    limits = traces.limits[..., None] if traces.limits.ndim == 2 else by_rows(traces.limits[:, :-1])
    share, shares = _saturation(size, peaks, limits * _AT_LIMIT)
    result |= _over_joints("saturation_fraction", share, shares, np.arange(len(prismatic)))
    result["energy"] = _over(work, np.arange(len(prismatic)))
    for effort, chosen in (("control_effort", ~prismatic), ("force_effort", prismatic)):
        if chosen.any():
            result[effort] = _over(squares, np.flatnonzero(chosen)) * context.period
    return result


def _saturation(size: FloatArray, peaks: FloatArray, limits: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the fraction of ticks with any joint at its limit, shape (runs,), and with each joint, shape (runs, nq).

    Args:
        size: Absolute torques, shape (runs, nq, ticks), in N m.
        peaks: Largest absolute torque of each joint, shape (runs, nq), in N m.
        limits: Smallest absolute torque that counts as at the limit, shape (runs, nq, 1) or (runs, nq, ticks), in N m.
    """
    share, shares = np.zeros(len(peaks)), np.zeros_like(peaks)
    some = np.flatnonzero((peaks >= limits.min(axis=2)).any(axis=1))
    if len(some):
        saturated = size[some] >= limits[some]
        share[some] = np.count_nonzero(saturated.any(axis=1), axis=1) / size.shape[2]
        shares[some] = np.count_nonzero(saturated, axis=2) / size.shape[2]
    return share, shares


def _squared_steps(held: FloatArray) -> FloatArray:
    """Return the sum over time of the squared torque changes of each joint, shape (runs, nq)."""
    steps = np.diff(held, axis=2)
    total: FloatArray = (steps * steps).sum(axis=2)
    return total


def _over(values: FloatArray, joints: NDArray[np.intp]) -> FloatArray:
    """Return the sum over the given joints, in their order, shapes (runs, nq) to (runs,)."""
    total = values[:, joints[0]].copy()
    for joint in joints[1:]:
        total += values[:, joint]
    return total


def _over_joints(name: str, overall: FloatArray, values: FloatArray, joints: NDArray[np.intp]) -> dict[str, FloatArray]:
    """Return a metric over the given joints, and of each joint, by name."""
    return {name: overall, **{f"{name}_q{joint + 1}": values[:, joint] for joint in joints}}
