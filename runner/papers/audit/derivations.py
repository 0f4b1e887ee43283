"""Reference derivations of printed equations, names of elements, transforms and differences."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce

import numpy as np

from runner.base.arrays import FloatArray

Symbols = Mapping[str, FloatArray]
"""Values of each symbol at the samples, by name; the first axis counts the samples."""
Elements = Mapping[str, FloatArray]
"""Values of each element of an equation at the samples: shape (T,), or (T, ...) where an element is a matrix."""
Derivation = Callable[[Symbols], Elements]
_STEP = 1e-3
_IDENTITY = np.eye(3)


@dataclass(frozen=True)
class Derivations:
    """Two independent derivations of what an equation claims to equal.

    Attributes:
        first: Derivation from the model, such as a chain of transforms.
        second: Derivation that shares only the arm's dimensions with the first, such as finite differences.
        methods: The method of each in a few words.
    """

    first: Derivation
    second: Derivation
    methods: tuple[str, str]


def elements(name: str, array: FloatArray, start: int = 1) -> dict[str, FloatArray]:
    """Return the elements of vectors (T, n) or matrices (T, m, n) by name: G_1, M_23; M_1_10 beyond nine.

    Args:
        name: Letter of the whole.
        array: Its values at the samples.
        start: Number of the first element.
    """
    apart, moved = "_" if max(array.shape[1:]) > 9 else "", np.moveaxis(array, 0, -1)
    places = itertools.product(*(range(size) for size in array.shape[1:]))
    return {f"{name}_{apart.join(str(i + start) for i in place)}": moved[place] for place in places}


def whole_and_elements(name: str, array: FloatArray, start: int = 1) -> dict[str, FloatArray]:
    """Return a vector or matrix under its name, and its elements under theirs."""
    return {name: array} | elements(name, array, start)


def coordinates(name: str, array: FloatArray, infix: str = "_") -> dict[str, FloatArray]:
    """Return the coordinates of vectors (T, 3) under their names: P_x, P_y, P_z."""
    return {f"{name}{infix}{axis}": array[:, place] for place, axis in enumerate("xyz")}


def along(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return each matrix times its vector, shapes (T, m, n) and (T, n) to (T, m)."""
    return np.asarray(np.einsum("tij,tj->ti", matrices, vectors))


def columns(values: Symbols, names: Sequence[str]) -> FloatArray:
    """Return values by name as the columns of one array, shape (T, n)."""
    return np.column_stack([values[name] for name in names])


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
