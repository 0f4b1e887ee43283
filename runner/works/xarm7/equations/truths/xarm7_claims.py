"""What the xArm7 report says of its first task in words: a line along y, 40 cm long, with three joints. In cm."""

from collections.abc import Callable

import numpy as np

from runner.audit.truth import Elements, FloatArray, Symbols, Truth
from runner.works.xarm7.equations.truths.xarm7 import L1, L2, L3, L4, L5, THETA1, THETA2, model_poses, pose
from runner.works.xarm7.equations.truths.xarm7_inverse import Q6, full

X, Z = 64.3, 15.08  # cm
ENDS = (-20.0, 20.0)  # cm
_LIMITS = np.array([[-2 * np.pi, -2.059488, -0.191986], [2 * np.pi, 2.094395, 3.926991]])  # joints 1, 2, 4, rad


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return points `y` of the line, shape (T,), in cm.

    Args:
        count: How many points.
        generator: Source of the draw.
    """
    return {"y": generator.uniform(*ENDS, count)}


def points(y: FloatArray) -> FloatArray:
    """Return the points of the report's line, shapes (T,) to (T, 3), in cm."""
    return np.column_stack([np.full(len(y), X), y, np.full(len(y), Z)])


def solve(target: FloatArray, *, q2_sign: float = 1.0, root: bool = True) -> FloatArray:
    """Return q1, q2, q4 by the report's inverse kinematics, shapes (T, 3) to (T, 3), in rad.

    Args:
        target: Tip positions, in cm.
        q2_sign: Sign in the denominator of q2: 1 right, -1 as printed.
        root: Whether M^2 stands under the root of q4, as it must; False is as printed.
    """
    r, z = np.hypot(target[:, 0], target[:, 1]), target[:, 2] - L1
    A = L4 * np.cos(THETA1) + L5 * np.cos(Q6 - THETA2)
    B = L4 * np.sin(THETA1) - L5 * np.sin(Q6 - THETA2)
    p1, p2 = -L2 * A + L3 * B, L2 * B + L3 * A
    M = (r**2 + z**2 - L2**2 - L3**2 - A**2 - B**2) / 2
    under = np.sqrt(p1**2 + p2**2 - M**2) if root else np.hypot(p1, p2) - M**2
    q4 = (np.arctan2(M, under) if root else np.arctan(M / under)) - np.arctan2(p1, p2)
    p3, p4 = L2 - A * np.cos(q4) + B * np.sin(q4), L3 + B * np.cos(q4) + A * np.sin(q4)
    above, below = p3 * r - p4 * z, p4 * r + q2_sign * p3 * z
    q2 = np.arctan2(above, below) if q2_sign > 0 else np.arctan(above / below)
    return np.column_stack([np.arctan2(target[:, 1], target[:, 0]), q2, q4])


def line(values: Symbols) -> Elements:
    """Return the line as the report gives it."""
    return {"tip": points(values["y"])}


def _reached(pose_of: Callable[[FloatArray], FloatArray], values: Symbols) -> Elements:
    q = solve(points(values["y"]))
    inside = ((q >= _LIMITS[0]) & (q <= _LIMITS[1])).all(axis=1)
    tips = pose_of(full(q))[:, :3, 3]
    return {"tip": np.where(inside[:, None], tips, np.nan)}


def along_x(values: Symbols) -> Elements:
    """Return the x axis, the direction that the report names."""
    return {"direction": np.tile([1.0, 0.0, 0.0], (len(values["y"]), 1))}


def along_y(values: Symbols) -> Elements:
    """Return the y axis."""
    return {"direction": np.tile([0.0, 1.0, 0.0], (len(values["y"]), 1))}


def _direction(tips: FloatArray) -> FloatArray:
    order = tips[np.argsort(tips[:, 1])]
    whole = order[-1] - order[0]
    return np.tile(whole / np.linalg.norm(whole), (len(tips), 1))


reach = Truth(
    lambda values: _reached(model_poses, values),
    lambda values: _reached(pose, values),
    ("inverse kinematics, then Pinocchio, inside the joint limits", "the same by the chain of transforms"),
)
direction = Truth(
    lambda values: {"direction": _direction(points(values["y"]))},
    lambda values: {"direction": _direction(model_poses(full(solve(points(values["y"]))))[:, :3, 3])},
    ("between the ends of the line", "between the tips that the joints reach"),
)
