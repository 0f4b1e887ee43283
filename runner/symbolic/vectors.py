"""Vectors and matrices of any scalar type, as lists; factors 0 and 1 need no operation.

A scalar is a float, an array over runs, or an expression. A known zero is the Python float 0.0, so massless links and
right angles generate no operations.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

Scalar = Any
Vector = Sequence[Scalar]
Matrix = Sequence[Vector]

_AXES = range(3)


def is_number(value: Scalar, number: float) -> bool:
    """Return True if a scalar is a float with this value."""
    return isinstance(value, float) and value == number


def times(a: Scalar, b: Scalar) -> Scalar:
    """Return a b."""
    if is_number(a, 0.0) or is_number(b, 0.0):
        return 0.0
    if is_number(a, 1.0):
        return b
    if is_number(b, 1.0):
        return a
    if is_number(a, -1.0):
        return -b
    return -a if is_number(b, -1.0) else a * b


def plus(a: Scalar, b: Scalar) -> Scalar:
    """Return a + b."""
    if is_number(a, 0.0):
        return b
    return a if is_number(b, 0.0) else a + b


def minus(a: Scalar, b: Scalar) -> Scalar:
    """Return a - b."""
    if is_number(b, 0.0):
        return a
    return -b if is_number(a, 0.0) else a - b


def add(*vectors: Vector) -> Vector:
    """Return the sum of vectors of equal length."""
    total = list(vectors[0])
    for vector in vectors[1:]:
        total = [plus(a, b) for a, b in zip(total, vector, strict=True)]
    return total


def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return [minus(x, y) for x, y in zip(a, b, strict=True)]


def scale(factor: Scalar, vector: Vector) -> Vector:
    """Return a vector times a scalar."""
    return [times(factor, entry) for entry in vector]


def dot(a: Vector, b: Vector) -> Scalar:
    """Return the inner product."""
    total: Scalar = 0.0
    for x, y in zip(a, b, strict=True):
        total = plus(total, times(x, y))
    return total


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b, shapes (3,)."""
    return [
        minus(times(a[1], b[2]), times(a[2], b[1])),
        minus(times(a[2], b[0]), times(a[0], b[2])),
        minus(times(a[0], b[1]), times(a[1], b[0])),
    ]


def product(A: Matrix, b: Vector) -> Vector:
    """Return A b."""
    return [dot(row, b) for row in A]


def transpose(A: Matrix) -> Matrix:
    """Return A^T."""
    return [list(column) for column in zip(*A, strict=True)]


def matrix_product(A: Matrix, B: Matrix) -> Matrix:
    """Return A B."""
    columns = transpose(B)
    return [[dot(row, column) for column in columns] for row in A]


def symmetric_product(A: Matrix, B: Matrix) -> Matrix:
    """Return A B, if it is symmetric: only its upper triangle is computed."""
    columns = transpose(B)
    upper = {(i, j): dot(A[i], columns[j]) for i in range(len(A)) for j in range(i, len(A))}
    return [[upper[min(i, j), max(i, j)] for j in range(len(A))] for i in range(len(A))]


def rotate_tensor(R: Matrix, A: Matrix) -> Matrix:
    """Return R A R^T of a symmetric A, shapes (3, 3)."""
    return symmetric_product(matrix_product(R, A), transpose(R))


def shift_inertia(inertia: Matrix, moment: Vector, mass: Scalar, r: Vector) -> Matrix:
    """Return the inertia of a body about another point, shape (3, 3).

    .. math:: I' = I + (2 r^T h + m r^T r) 1 - (h r^T + r h^T + m r r^T)

    Args:
        inertia: I about the first point.
        moment: h, mass times the vector from the first point to the centre of mass, shape (3,).
        mass: m.
        r: Vector from the new point to the first point, shape (3,).
    """
    lever = add(moment, scale(mass, r))  # h + m r
    spread = plus(dot(r, moment), dot(r, lever))

    def entry(i: int, j: int) -> Scalar:
        moved = plus(times(moment[i], r[j]), times(r[i], lever[j]))
        return minus(plus(inertia[i][j], spread) if i == j else inertia[i][j], moved)

    upper = {(i, j): entry(i, j) for i in _AXES for j in _AXES if i <= j}
    return [[upper[min(i, j), max(i, j)] for j in _AXES] for i in _AXES]


def as_array(values: Vector | Matrix) -> Any:
    """Return scalars as a NumPy array of objects, of the same shape."""
    return np.array(values, dtype=object)
