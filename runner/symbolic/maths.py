"""Scalar functions for control laws, in addition to NumPy's operators: protocol and float version."""

import operator
from collections.abc import Callable
from math import exp, expm1, floor
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from runner.base import portable
from runner.base.lazy_modules import lapack, pin

Array = NDArray[Any]
"""An array of floats, or of objects that represent numbers."""
Scalar = Any
"""A float or an object that represents one; also a condition."""
Chosen = TypeVar("Chosen", bound=Array | tuple[Array, ...])


class Backend(Protocol):
    """Functions over one kind of scalar.

    A law that uses these functions, and the operators and `dot` of NumPy's arrays, can be evaluated on floats and
    written as expressions. It branches only by `choose`. `singular` is the error message for a system without solution;
    if it is None, the result is meaningless then.
    """

    def choose(self, condition: Scalar, yes: Callable[[], Chosen], no: Callable[[], Chosen]) -> Chosen:
        """Return the result of one of two functions, arrays or tuples of arrays; on floats, the other is not called."""

    def less(self, a: Scalar, b: Scalar) -> Scalar:
        """Return the condition a < b of two scalars, or of two arrays entry by entry."""

    def equal(self, a: Scalar, b: Scalar) -> Scalar:
        """Return the condition a = b of two scalars, or of two arrays entry by entry."""

    def any_of(self, *conditions: Scalar) -> Scalar:
        """Return the condition that at least one condition holds."""

    def first(self, conditions: Array) -> tuple[Array, Scalar]:
        """Return for each condition whether it is the first that holds, shape (n,), and the condition that none is."""

    def select(self, condition: Scalar, yes: Scalar, no: Scalar) -> Scalar:
        """Return one of two scalars, or of the entries of two arrays by conditions; both are computed before."""

    def maximum(self, a: Scalar, b: Scalar) -> Scalar:
        """Return the larger of two scalars."""

    def floor(self, a: Scalar) -> Scalar:
        """Return the largest integer that is not greater than a scalar."""

    def absolute(self, a: Scalar) -> Scalar:
        """Return the absolute value of a scalar, or of the entries of an array."""

    def sqrt(self, a: Scalar) -> Scalar:
        """Return the square root of a scalar."""

    def decay(self, x: Scalar) -> tuple[Scalar, Scalar]:
        """Return exp(-x) and 1 - exp(-x) of a scalar that is not negative."""

    def solve_three(self, A: Array, b: Array, singular: str | None) -> tuple[Array, Scalar]:
        """Return A^-1 b and det A, with A of shape (3, 3) and b of shape (3,)."""

    def solve_symmetric(self, A: Array, b: Array, singular: str | None) -> Array:
        """Return A^-1 b of a positive definite A, with only its upper triangle read; b of shape (n,) or (n, k)."""

    def solve_chosen(self, A: Array, b: Array, chosen: Array) -> Array:
        """Return A^-1 b of the rows and columns of a positive definite A that conditions choose; 0 in other rows."""

    def positive_definite(self, A: Array) -> Scalar:
        """Return the condition that a symmetric A is positive definite."""

    def smallest_eigenvalue(self, A: Array) -> Scalar:
        """Return the smallest eigenvalue of a symmetric A that is positive definite or nearly so."""

    def rotation_vector(self, R: Array) -> Array:
        """Return axis times angle of a rotation of less than half a turn, shapes (3, 3) and (3,), in rad."""


class _NumpyBackend:
    """The functions on floats; see Backend."""

    less, equal = staticmethod(operator.lt), staticmethod(operator.eq)
    maximum, absolute = staticmethod(max), staticmethod(abs)

    def choose(self, condition: Scalar, yes: Callable[[], Chosen], no: Callable[[], Chosen]) -> Chosen:
        return yes() if condition else no()

    def any_of(self, *conditions: Scalar) -> Scalar:
        return any(conditions)

    def select(self, condition: Scalar, yes: Scalar, no: Scalar) -> Scalar:
        if isinstance(condition, np.ndarray):
            return np.where(condition, yes, no)
        return yes if condition else no

    def first(self, conditions: Array) -> tuple[Array, Scalar]:
        first, at = np.zeros(len(conditions), dtype=bool), conditions.argmax()
        first[at] = conditions[at]
        return first, not conditions[at]

    def floor(self, a: Scalar) -> Scalar:
        return float(floor(a))

    def sqrt(self, a: Scalar) -> Scalar:
        return float(np.sqrt(a))

    def decay(self, x: Scalar) -> tuple[Scalar, Scalar]:
        return exp(-x), -expm1(-x)

    def solve_three(self, A: Array, b: Array, singular: str | None) -> tuple[Array, Scalar]:
        lu, pivots, solution, info = lapack.dgesv(A, b)
        if info and singular is not None:
            raise np.linalg.LinAlgError(singular)
        swaps = int(pivots[0] != 0) + int(pivots[1] != 1)
        determinant = lu[0, 0] * lu[1, 1] * lu[2, 2]
        return solution, -determinant if swaps == 1 else determinant

    def solve_symmetric(self, A: Array, b: Array, singular: str | None) -> Array:
        _, solution, info = lapack.dposv(A, b)
        if info and singular is not None:
            raise np.linalg.LinAlgError(singular)
        return np.asarray(solution)

    def solve_chosen(self, A: Array, b: Array, chosen: Array) -> Array:
        x = np.zeros(len(b))
        if chosen.any():
            x[chosen] = portable.solve_symmetric(A[np.ix_(chosen, chosen)], b[chosen])
        return x

    def positive_definite(self, A: Array) -> Scalar:
        return lapack.dpotrf(A)[1] == 0

    def smallest_eigenvalue(self, A: Array) -> Scalar:
        return float(np.linalg.eigvalsh(A)[0])

    def rotation_vector(self, R: Array) -> Array:
        return np.asarray(pin.log3(R))


NUMPY: Backend = _NumpyBackend()
