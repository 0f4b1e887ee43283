"""Functions of arrays with the same bits on every x86-64 processor with AVX2.

NumPy's exp, power and inverse trigonometric functions, and BLAS' scalar products, have other code for other processors,
whose last digits differ. These use `math`, products and sums in a fixed order, and Eigen, which has one code for all.
"""

import math

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import eigen


def exp(values: FloatArray) -> FloatArray:
    """Return the exponential of each element, in the shape of the values."""
    return np.array([math.exp(value) for value in values.ravel().tolist()]).reshape(values.shape)


def expm1(values: FloatArray) -> FloatArray:
    """Return the exponential of each element minus 1, in the shape of the values."""
    return np.array([math.expm1(value) for value in values.ravel().tolist()]).reshape(values.shape)


def solve_symmetric(A: FloatArray, b: FloatArray, singular: str = "the matrix is singular") -> FloatArray:
    """Return the solution x of A x = b, in the shape of b, by Eigen's pivoted Cholesky factorisation.

    Args:
        A: Symmetric, positive or negative semidefinite, shape (n, n); its upper triangle is not read.
        b: Right side, shape (n,) or (n, k).
        singular: Message if A is singular.

    Raises:
        numpy.linalg.LinAlgError: if A is singular.
    """
    factors = eigen.LDLT(A)
    if np.count_nonzero(factors.vectorD()) < len(b):
        raise np.linalg.LinAlgError(singular)
    x: FloatArray = factors.solve(b)
    return x.reshape(b.shape)  # eigenpy gives other shapes for n = 1


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the scalar products along the last axis, shapes (..., n) and (..., n) to (...)."""
    product: FloatArray = np.add.reduce(a * b, axis=-1)
    return product


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return a x b along the last axis, shapes (..., 3); on small arrays faster than NumPy's."""
    product = np.empty(a.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        product[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return product


def norm(vector: FloatArray) -> float:
    """Return the length of a vector, shape (n,)."""
    return math.sqrt(dot(vector, vector))


def unit(vector: FloatArray) -> FloatArray:
    """Return the unit vector along a vector that is not zero, shape (n,)."""
    return vector / norm(vector)
