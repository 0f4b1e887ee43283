"""Joint of a stored run that is nearest to its torque limit, and how much of its speed it uses."""

from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number, quantity
from runner.store import Run


def nearest_to_limit(run: Run) -> tuple[str, str, str] | None:
    """Return the joint nearest to its torque limit in repetition 0: what it is, its share, and when and how fast.

    Returns:
        A number of a first screen; None for a failed run and for an arm without limits.
    """
    if run.status == "failed":
        return None
    model, torques, speeds = run.model, np.abs(run.joints("tau")[:-1]), np.abs(run.joints("dq"))
    limits = np.minimum(model.effort_limits, _configured(run.config["torque_limits"]["max"], torques.shape[1]))
    known = np.isfinite(limits) & (limits > 0.0)
    if not known.any() or not len(torques):
        return None
    shares = np.where(known, torques / np.where(known, limits, 1.0), 0.0)
    row, joint = np.unravel_index(int(shares.argmax()), shares.shape)
    at = quantity(float(run.t[row]), "s", 2)
    fastest = float(model.velocity_limits[joint])
    peak = 100.0 * float(speeds[:, joint].max()) / fastest
    speed = f", up to {number(peak, 2)} % of its speed" if np.isfinite(fastest) and fastest > 0.0 else ""
    name = run.provenance["joints"][int(joint)]
    share = number(100.0 * min(float(shares[row, joint]), 1.0), 2)
    return "nearest to a torque limit", f"{name}: {share} %", f"at {at}{speed}; repetition 0"


def _configured(largest: Any, joints: int) -> FloatArray:
    """Return the torque limit of each joint in a config, shape (joints,); infinite without one, and by stage."""
    if isinstance(largest, list) and len(largest) == joints:
        return np.array([np.inf if one is None else float(one) for one in largest])
    return np.full(joints, float(largest) if isinstance(largest, int | float) else np.inf)
