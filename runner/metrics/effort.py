"""What a motion asks of the joints."""

import numpy as np

from runner.metrics.context import MetricContext
from runner.trace import Trace

UNITS = {
    "peak_torque": "N m",
    "rms_torque": "N m",
    "peak_joint_speed": "rad/s",
    "peak_joint_force": "N",
    "rms_joint_force": "N",
    "peak_sliding_speed": "m/s",
    "saturation_fraction": "1",
    "energy": "J",
    "control_effort": "N^2 m^2 s",
    "force_effort": "N^2 s",
}


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return torques, speeds, saturation, energy and effort, over the torques that were held (all rows but the last).

    - peak_torque: largest magnitude of a joint's torque; over all that turn, and per joint, as peak_torque_q1.
    - rms_torque: root mean square of the torques, likewise.
    - peak_joint_speed: largest joint speed, likewise.
    - peak_joint_force, rms_joint_force, peak_sliding_speed: the same of the joints that slide, where there are any.
    - saturation_fraction: share of ticks with any joint at its limit; per joint, of those with this one.
    - energy: integral of sum |tau dq|, exact while no joint reverses within a tick, as the torque is held.
    - control_effort: integral of sum tau^2; over the joints that turn.
    - force_effort: the same over those that slide, where there are any.
    """
    tau, speed = trace.tau[:-1], np.abs(trace.dq)
    saturated = np.abs(tau) >= trace.limits * (1.0 - 1e-12)
    slides = np.array([unit == "m" for unit in trace.joint_units])
    result: dict[str, float | None] = {}
    for peak, rms, fastest, chosen in (
        ("peak_torque", "rms_torque", "peak_joint_speed", ~slides),
        ("peak_joint_force", "rms_joint_force", "peak_sliding_speed", slides),
    ):
        if chosen.any():
            own, rates = np.ascontiguousarray(tau[:, chosen]), speed[:, chosen]
            result |= _over_joints(peak, np.abs(own).max(), np.abs(own).max(axis=0), chosen)
            result |= _over_joints(rms, np.sqrt((own**2).mean()), np.sqrt((own**2).mean(axis=0)), chosen)
            result |= _over_joints(fastest, rates.max(), rates.max(axis=0), chosen)
    everywhere = np.ones_like(slides)
    result |= _over_joints("saturation_fraction", saturated.any(axis=1).mean(), saturated.mean(axis=0), everywhere)
    result["energy"] = float(np.abs(tau * np.diff(trace.q, axis=0)).sum())
    for effort, chosen in (("control_effort", ~slides), ("force_effort", slides)):
        if chosen.any():
            result[effort] = float((np.ascontiguousarray(tau[:, chosen]) ** 2).sum() * context.period)
    return result


def _over_joints(name: str, overall: float, values: np.ndarray, chosen: np.ndarray) -> dict[str, float | None]:
    """Return a metric over the chosen joints, and of each, by name."""
    joints = [f"q{index + 1}" for index in np.flatnonzero(chosen)]
    each = {f"{name}_{joint}": float(value) for joint, value in zip(joints, values, strict=True)}
    return {name: float(overall), **each}
