"""Homogeneous transforms for many configurations at once, and Jacobians by finite differences."""

from collections.abc import Callable, Sequence
from functools import lru_cache, reduce

import numpy as np

from runner.base.arrays import FloatArray

_STEP = 1e-3
_IDENTITY = np.eye(3)


def turn(axis: FloatArray, angles: FloatArray) -> FloatArray:
    """Return homogeneous rotations about an axis of length 1, shape (T, 4, 4), by Rodrigues' formula; angles in rad."""
    K, squared = _cross(*axis)
    result = np.zeros((len(angles), 4, 4))
    result[:, :3, :3] = _IDENTITY + (np.sin(angles)[:, None, None] * K + (1 - np.cos(angles))[:, None, None] * squared)
    result[:, 3, 3] = 1.0
    return result


@lru_cache(maxsize=64)  # a chain turns about few axes, very often
def _cross(x: float, y: float, z: float) -> tuple[FloatArray, FloatArray]:
    """Return the matrix of the cross product with an axis, and its square, shape (3, 3) each."""
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return K, K @ K


def rotation(axis: str, angle: FloatArray | float) -> FloatArray:
    """Return homogeneous rotations about a coordinate axis, shape (T, 4, 4); angles of shape (T,) or one, in rad."""
    return turn(_IDENTITY["xyz".index(axis)], np.atleast_1d(np.asarray(angle, dtype=float)))


def translation(axis: str, length: float) -> FloatArray:
    """Return a homogeneous translation along a coordinate axis, shape (1, 4, 4)."""
    result = np.eye(4)[None].copy()
    result[0, "xyz".index(axis), 3] = length
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
