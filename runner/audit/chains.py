"""Chains of elementary transforms at many configurations at once, and derivatives by differences."""

from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np
import pinocchio as pin

from runner.audit.truth import FloatArray
from runner.robots.model import RobotModel

_STEP = 1e-3
_AXES = {"x": 0, "y": 1, "z": 2}


def rotation(axis: str, angle: FloatArray | float) -> FloatArray:
    """Return homogeneous rotations about a coordinate axis, shape (T, 4, 4); angles of shape (T,) or one, in rad."""
    angles = np.atleast_1d(np.asarray(angle, dtype=float))
    result = np.tile(np.eye(4), (len(angles), 1, 1))
    first, second = [(1, 2), (2, 0), (0, 1)][_AXES[axis]]
    c, s = np.cos(angles), np.sin(angles)
    result[:, first, first], result[:, first, second] = c, -s
    result[:, second, first], result[:, second, second] = s, c
    return result


def translation(axis: str, length: float) -> FloatArray:
    """Return a homogeneous translation along a coordinate axis, shape (1, 4, 4)."""
    result = np.eye(4)[None].copy()
    result[0, _AXES[axis], 3] = length
    return result


def placed(position: Sequence[float], rotated: FloatArray) -> FloatArray:
    """Return a homogeneous transform with the rotation of another and this position, shape (4, 4)."""
    result = rotated.copy()
    result[:3, 3] = position
    return result


def product(transforms: Sequence[FloatArray]) -> FloatArray:
    """Return the product of transforms, shape (T, 4, 4)."""
    return reduce(np.matmul, transforms)


def derivative(function: Callable[[FloatArray], FloatArray], q: FloatArray, joint: int) -> FloatArray:
    """Return a function's derivative with respect to one joint position, by central differences of fourth order.

    Args:
        function: Of joint positions, shape (T, n), with values of any shape (T, ...).
        q: Joint positions, shape (T, n), in rad.
        joint: Index of the joint.
    """

    def at(steps: float) -> FloatArray:
        moved = q.copy()
        moved[:, joint] += steps * _STEP
        return function(moved)

    return (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * _STEP)


def jacobian_by_differences(pose: Callable[[FloatArray], FloatArray], q: FloatArray) -> FloatArray:
    """Return the basic Jacobians of a pose, shape (T, 6, n), linear rows first, by differences.

    The angular rows are read from the skew matrix dR/dq R'.

    Args:
        pose: Homogeneous transforms, shape (T, 4, 4), of joint positions, shape (T, n).
        q: Joint positions, shape (T, n), in rad.
    """
    R = pose(q)[:, :3, :3]
    columns = []
    for joint in range(q.shape[1]):
        change = derivative(pose, q, joint)
        spin = change[:, :3, :3] @ R.transpose(0, 2, 1)
        columns.append(np.column_stack([change[:, :3, 3], spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]]))
    return np.stack(columns, axis=2)


def chain_model(placements: Sequence[FloatArray]) -> RobotModel:
    """Return a chain of revolute joints about their z axes as a Pinocchio model, without masses, its tip named "tip".

    Args:
        placements: Homogeneous transform of each joint in the frame of the one before it; the last is the tip's.
    """
    lines = ['<robot name="chain"><link name="link0"/>']
    for place, placement in enumerate(placements, start=1):
        last = place == len(placements)
        child, kind = ("tip", "fixed") if last else (f"link{place}", "revolute")
        xyz, rpy = placement[:3, 3], pin.rpy.matrixToRpy(placement[:3, :3])
        lines.append(f'<link name="{child}"/><joint name="joint{place}" type="{kind}">')
        lines.append(f'<origin xyz="{_row(xyz)}" rpy="{_row(rpy)}"/><axis xyz="0 0 1"/>')
        lines.append('<limit lower="-1e3" upper="1e3" effort="0" velocity="0"/>')
        lines.append(f'<parent link="link{place - 1}"/><child link="{child}"/></joint>')
    return RobotModel("".join([*lines, "</robot>"]), "tip")


def _row(values: FloatArray) -> str:
    return " ".join(repr(float(value)) for value in values)
