"""Wrenches seen from another frame (Meca500 report, section 6)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.errors import ConfigError, nearest
from runner.robots.model import FloatArray, RobotModel


def cross(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """Return a x b, shapes (3,), of any kind of scalar; numpy's own takes ten times as long for single vectors."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))


def cross_matrix(vector: FloatArray) -> FloatArray:
    """Return [v]_x, shape (3, 3), so that [v]_x w = v x w."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def wrench_transform(pose: FloatArray) -> FloatArray:
    r"""Return the matrix that takes wrenches from a frame S1 to a frame S2.

    With R and p the orientation and origin of S1 in S2,

    .. math:: F_2 = R F_1, \qquad M_2 = R M_1 + p \times R F_1

    The power of a wrench is the same in both. The report writes the moment about q as that about p plus the lever
    from q to p times the force, and in one of three lines "M_p" where M_q is meant; its final matrix is this one.

    Args:
        pose: Homogeneous transform of S1 in S2, shape (4, 4).

    Returns:
        Shape (6, 6), for wrenches of a force in N and then a moment about the frame's origin in N m.
    """
    R, p = pose[:3, :3], pose[:3, 3]
    transform = np.zeros((6, 6))
    transform[:3, :3] = transform[3:, 3:] = R
    transform[3:, :3] = cross_matrix(p) @ R
    return transform


def wrench_seen_from(model: RobotModel, q: FloatArray, wrench: FloatArray, source: str, target: str) -> FloatArray:
    """Return a wrench given in one frame of the arm as another frame sees it.

    Args:
        model: The arm.
        q: Joint positions, shape (nq,), in rad.
        wrench: Force in N and moment about the source's origin in N m, along its axes, shape (6,).
        source: Name of the frame in which the wrench is given.
        target: Name of the frame from which it is seen.

    Raises:
        ConfigError: if the arm has no such frame; names the frames it has.
    """
    frames = [frame.name for frame in model.pin_model.frames]
    unknown = [name for name in (source, target) if name not in frames]
    if unknown:
        raise ConfigError(
            f"wrench frame '{name}' does not exist{nearest(name, frames)}; frames: {', '.join(frames)}"
            for name in unknown
        )
    source_pose, target_pose = model.frame_poses(q, (source, target))
    seen: FloatArray = wrench_transform(np.linalg.solve(target_pose, source_pose)) @ wrench
    return seen
