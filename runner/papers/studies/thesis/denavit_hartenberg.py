"""Standard (distal) Denavit-Hartenberg parameters of a serial arm, from its joint axes (thesis section 3.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.robots.model import RobotModel

_TOLERANCE = 1e-9  # of a sine (parallel axes) and of the arm's size (coincident points)


@dataclass(frozen=True)
class DenavitHartenbergRow:
    """Row of a standard (distal) D-H table: joint i turns about z_{i-1}, and frame i is at the distal end of link i.

    Attributes:
        theta: Angle from x_{i-1} to x_i about z_{i-1} at q_i = 0, in rad; the joint position is added to it.
        d: Distance from x_{i-1} to x_i along z_{i-1}, in m.
        a: Distance from z_{i-1} to z_i along x_i, in m.
        alpha: Angle from z_{i-1} to z_i about x_i, in rad.
    """

    theta: float
    d: float
    a: float
    alpha: float


def transform(row: DenavitHartenbergRow, q: float) -> FloatArray:
    """Return the transform from frame i to frame i-1 at joint position q in rad, shape (4, 4) (thesis eq. 3.2)."""
    c, s = np.cos(row.theta + q), np.sin(row.theta + q)
    ca, sa = np.cos(row.alpha), np.sin(row.alpha)
    return np.array(
        [
            [c, -s * ca, s * sa, row.a * c],
            [s, c * ca, -c * sa, row.a * s],
            [0.0, sa, ca, row.d],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def frames(rows: Sequence[DenavitHartenbergRow], q: FloatArray) -> FloatArray:
    """Return frames 0 to n in the base frame at joint positions q, shape (n + 1, 4, 4) (thesis eq. 3.1)."""
    transforms = (transform(row, float(q_i)) for row, q_i in zip(rows, q, strict=True))
    return np.array(list(accumulate(transforms, np.matmul, initial=np.eye(4))))


def denavit_hartenberg(model: RobotModel) -> tuple[DenavitHartenbergRow, ...]:
    """Return the standard D-H table of an arm, so that the product of its transforms is the pose of the tip.

    Frame 0 is the base frame. z_i is along the axis of joint i+1. If the axes z_{i-1} and z_i intersect or are skew,
    x_i is along z_{i-1} x z_i, so a_i is negative if the common normal has the opposite direction. If they are
    parallel, x_i is along the common normal with d_i = 0. The last frame is the tip frame.

    Args:
        model: The robot; every joint must move the tip.

    Returns:
        One row for each joint.

    Raises:
        ConfigError: if joint 1 does not turn about the z axis of the base, a joint does not move the tip, or a single
            D-H row cannot reach the tip frame.
    """
    home = np.zeros(model.nq)
    axes = model.tip_jacobian(home)[3:].T
    origins = model.frame_poses(home, model.joint_names)[:, :3, 3]
    still = [name for name, axis in zip(model.joint_names, axes, strict=True) if np.linalg.norm(axis) < 0.5]
    if still:
        raise ConfigError(f"robot.tip: joint {', '.join(still)} does not move the tip; D-H needs a chain up to it")
    size = max(1.0, float(np.abs(origins).max()))
    if np.linalg.norm(axes[0] - [0.0, 0.0, 1.0]) > _TOLERANCE or np.hypot(*origins[0][:2]) > _TOLERANCE * size:
        raise ConfigError(
            f"robot.urdf: joint '{model.joint_names[0]}' turns about {np.round(axes[0], 6).tolist()} through "
            f"{np.round(origins[0], 6).tolist()} m; D-H parameters need the z axis of the base"
        )
    poses = [np.eye(4)]
    for axis, origin in zip(axes[1:], origins[1:], strict=True):
        poses.append(_next_frame(poses[-1], axis, origin))
    poses.append(model.tip_pose(home))
    rows = tuple(_row(before, after) for before, after in pairwise(poses))
    missing = float(np.abs(frames(rows, home)[-1] - poses[-1]).max())
    if missing > _TOLERANCE * size:
        raise ConfigError(
            f"robot.tip: the tip frame is off by {missing:.3g} from the nearest D-H frame; its x axis must meet "
            f"the axis of joint '{model.joint_names[-1]}' at a right angle. Turn the tip frame in the URDF"
        )
    return rows


def _next_frame(before: FloatArray, axis: FloatArray, point: FloatArray) -> FloatArray:
    """Return the D-H frame on a joint axis, through a point in the base frame, that follows the given frame."""
    z, origin = before[:3, 2], before[:3, 3]
    normal = np.cross(z, axis)
    sine = float(np.linalg.norm(normal))
    if sine > _TOLERANCE:
        x = normal / sine
        # The common normal meets the new axis at origin + d z + a x = point + s axis, solved for s.
        new_origin = point + axis * (np.cross(origin - point, z) @ normal) / -(sine**2)
    else:
        new_origin = point + axis * ((origin - point) @ axis)  # nearest to the last origin, so that d = 0
        offset = new_origin - origin
        length = float(np.linalg.norm(offset))
        x = offset / length if length > _TOLERANCE * max(1.0, float(np.linalg.norm(point))) else before[:3, 0]
    x = x - (x @ axis) * axis
    x = x / np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(axis, x), axis])
    pose[:3, 3] = new_origin
    return pose


def _row(before: FloatArray, after: FloatArray) -> DenavitHartenbergRow:
    step = np.linalg.solve(before, after)
    theta = np.arctan2(step[1, 0], step[0, 0])
    a = step[0, 3] * np.cos(theta) + step[1, 3] * np.sin(theta)
    values = (_positive(theta), step[2, 3], a, _positive(np.arctan2(step[2, 1], step[2, 2])))
    return DenavitHartenbergRow(*(0.0 if abs(value) < 1e-14 else float(value) for value in values))


def _positive(angle: float) -> float:
    """Return an angle, with -pi replaced by pi, because rounding can change its sign."""
    return angle + 2.0 * np.pi if angle < _TOLERANCE - np.pi else angle
