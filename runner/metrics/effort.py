"""What a motion asks of the joints."""

import numpy as np

from runner.metrics.context import MetricContext
from runner.trace import Trace

UNITS = {
    "peak_torque": "N m",
    "rms_torque": "N m",
    "peak_joint_speed": "rad/s",
    "saturation_fraction": "1",
    "energy": "J",
    "control_effort": "N^2 m^2 s",
}


def evaluate(trace: Trace, context: MetricContext) -> dict[str, float | None]:
    """Return torques, speeds, saturation, energy and effort, over the torques that were held (all rows but the last).

    - peak_torque: largest magnitude of a joint's torque; so over all joints, and per joint, as peak_torque_q1.
    - rms_torque: root mean square of the torques, likewise.
    - peak_joint_speed: largest joint speed, likewise.
    - saturation_fraction: share of ticks with any joint at its limit; per joint, of those with this one.
    - energy: integral of sum |tau dq|, exact while no joint reverses within a tick, as the torque is held.
    - control_effort: integral of sum tau^2.
    """
    tau, speed = trace.tau[:-1], np.abs(trace.dq)
    saturated = np.abs(tau) >= trace.limits * (1.0 - 1e-12)
    joints = [f"q{index + 1}" for index in range(tau.shape[1])]
    per_joint = {
        "peak_torque": np.abs(tau).max(axis=0),
        "rms_torque": np.sqrt((tau**2).mean(axis=0)),
        "peak_joint_speed": speed.max(axis=0),
        "saturation_fraction": saturated.mean(axis=0),
    }
    overall = {
        "peak_torque": np.abs(tau).max(),
        "rms_torque": np.sqrt((tau**2).mean()),
        "peak_joint_speed": speed.max(),
        "saturation_fraction": saturated.any(axis=1).mean(),
    }
    result: dict[str, float | None] = {}
    for name, values in per_joint.items():
        result[name] = float(overall[name])
        result |= {f"{name}_{joint}": float(value) for joint, value in zip(joints, values, strict=True)}
    result["energy"] = float(np.abs(tau * np.diff(trace.q, axis=0)).sum())
    result["control_effort"] = float((tau**2).sum() * context.period)
    return result
