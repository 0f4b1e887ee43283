"""Truths of printed equations: two independent evaluations, and the names of elements."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from runner.base.arrays import FloatArray

Symbols = Mapping[str, FloatArray]
"""Values of each symbol at the samples, by name; the first axis counts the samples."""

Elements = Mapping[str, FloatArray]
"""Values of each element of an equation at the samples: shape (T,), or (T, ...) where an element is a matrix."""

Way = Callable[[Symbols], Elements]


@dataclass(frozen=True)
class Truth:
    """What an equation claims to equal.

    Attributes:
        first: One way to work it out, from the model: a chain of transforms, Pinocchio.
        second: Another that shares nothing with it but the arm's measures, such as finite differences.
        ways: The two in a few words, for the report.
    """

    first: Way
    second: Way
    ways: tuple[str, str]


def elements(name: str, array: FloatArray, start: int = 1) -> dict[str, FloatArray]:
    """Return the elements of vectors (T, n) or matrices (T, m, n) by name: G_1, M_23; M_1_10 beyond nine.

    Args:
        name: Letter of the whole.
        array: Its values at the samples.
        start: Number of the first element.
    """
    apart, moved = "_" if max(array.shape[1:]) > 9 else "", np.moveaxis(array, 0, -1)
    places = product(*(range(size) for size in array.shape[1:]))
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
