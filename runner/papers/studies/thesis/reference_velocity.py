"""Speed of the Mini's target, seen from its base and from the ground."""

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.store import Run


def speed_seen(run: Run) -> FloatArray:
    """Return the speed of the Mini's target in its own base frame between ticks, shape (T - 1,), in m/s."""
    return _speeds(run, _wrist_rotations(run))


def speed_on_the_ground(run: Run) -> FloatArray:
    """Return the speed of x_d - x_E in the base frame between ticks, shape (T - 1,), in m/s."""
    return _speeds(run, np.broadcast_to(np.eye(3), (len(run.t), 3, 3)))


def _speeds(run: Run, frames: FloatArray) -> FloatArray:
    """Return the speed of x_d - x_E in frames with these rotations into the robot's, shape (T, 3, 3)."""
    rest = run.vector("desired") - run.vector("macro_tip")
    steps = np.diff(np.einsum("tji,tj->ti", frames, rest), axis=0)
    return np.asarray(np.linalg.norm(steps / np.diff(run.t)[:, None], axis=1))


def _wrist_rotations(run: Run) -> FloatArray:
    """Return the true rotation from the Mini's base frame into the robot's at each tick, shape (T, 3, 3)."""
    model = run.model
    base = model.pin_model.getFrameId(run.provenance["stages"]["mini"])
    data = model.pin_model.createData()
    rotations = np.full((len(run.t), 3, 3), np.nan)
    for row, q in zip(rotations, run.joints("q"), strict=True):
        if np.isfinite(q).all():
            pin.forwardKinematics(model.pin_model, data, q)
            row[:] = pin.updateFramePlacement(model.pin_model, data, base).rotation
    return rotations
