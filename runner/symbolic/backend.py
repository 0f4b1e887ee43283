"""Scalar functions for control laws on expressions; see runner/symbolic/maths.py."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from runner.symbolic.algebra import Factors
from runner.symbolic.expression import (
    absolute,
    all_of,
    angle_of,
    both,
    decay,
    equal,
    expression,
    floor,
    less,
    negated,
    select,
    sqrt,
)
from runner.symbolic.maths import Array, Chosen
from runner.symbolic.vectors import as_array, cross, dot, scale

_STEPS = 6  # of Laguerre's method, with cubic convergence


class SymbolicBackend:
    """The functions on expressions: both branches of a choice are computed, and an error is a number.

    Attributes:
        errors: Messages of the possible failures, in the order of the numbers in `fault`.
        fault: Number of the first failure, counted from 1; 0 without a failure.
    """

    # Of scalars, and of arrays entry by entry.
    less: Any = staticmethod(np.frompyfunc(less, 2, 1))
    equal: Any = staticmethod(np.frompyfunc(equal, 2, 1))
    select: Any = staticmethod(np.frompyfunc(select, 3, 1))
    absolute: Any = staticmethod(np.frompyfunc(absolute, 1, 1))
    floor, sqrt, decay = staticmethod(floor), staticmethod(sqrt), staticmethod(decay)

    def __init__(self) -> None:
        self.errors: list[str] = []
        self.fault: Any = 0.0
        self._within: list[Any] = []  # conditions of the enclosing choices

    def choose(self, condition: Any, yes: Callable[[], Chosen], no: Callable[[], Chosen]) -> Chosen:
        """Return one of two arrays or tuples of them, entry by entry; see Backend."""
        chosen: Any = self._inside(condition, yes)
        other: Any = self._inside(negated(condition), no)
        if isinstance(chosen, tuple):
            return cast(
                Chosen, tuple(np.asarray(self.select(condition, *pair)) for pair in zip(chosen, other, strict=True))
            )
        return cast(Chosen, np.asarray(self.select(condition, chosen, other)))

    def any_of(self, *conditions: Any) -> Any:
        """Return the condition that at least one condition holds; see Backend."""
        return negated(all_of([negated(condition) for condition in conditions]))

    def first(self, conditions: Array) -> tuple[Array, Any]:
        """Return which condition is the first that holds, and whether none does; see Backend."""
        first, none = [conditions[0]], negated(conditions[0])
        for condition in conditions[1:]:
            first.append(both(none, condition))
            none = both(none, negated(condition))
        return np.asarray(as_array(first)), none

    def maximum(self, a: Any, b: Any) -> Any:
        """Return the larger one; see Backend."""
        return select(less(b, a), a, b)

    def solve_three(self, A: Array, b: Array, singular: str | None) -> tuple[Array, Any]:
        """Return A^-1 b and det A by Cramer's rule; a singular A, up to rounding, is a failure. See Backend."""
        first, second, third = (list(column) for column in A.T)
        rows = [cross(second, third), cross(third, first), cross(first, second)]
        determinant = expression(dot(first, rows[0]))
        if singular is not None:
            size = dot(A.ravel().tolist(), A.ravel().tolist())
            self._watch(self.less(determinant * determinant, 1e-31 * size * size * size), singular)
        return as_array(scale(1.0 / determinant, [dot(row, list(b)) for row in rows])), determinant

    def solve_symmetric(self, A: Array, b: Array, singular: str | None) -> Array:
        """Return A^-1 b by A = L D L^T; see Backend."""
        factors = Factors(A.tolist())
        if singular is not None:
            self._watch(negated(_all_positive(factors)), singular)
        if b.ndim == 1:
            return np.asarray(as_array(factors.solve(b.tolist())))
        return np.asarray(as_array([factors.solve(column) for column in b.T.tolist()]).T)

    def solve_chosen(self, A: Array, b: Array, chosen: Array) -> Array:
        """Return A^-1 b of chosen rows: any other row of the system has only a one on the diagonal; see Backend."""
        rows = range(len(b))
        system = [
            [
                select(chosen[i], A[i, i], 1.0) if i == j else select(both(chosen[i], chosen[j]), A[i, j], 0.0)
                for j in rows
            ]
            for i in rows
        ]
        return np.asarray(as_array(Factors(system).solve([select(chosen[i], b[i], 0.0) for i in rows])))

    def positive_definite(self, A: Array) -> Any:
        """Return the condition that all pivots are above 0; see Backend."""
        return _all_positive(Factors(A.tolist()))

    def smallest_eigenvalue(self, A: Array) -> Any:
        r"""Return the smallest eigenvalue by Laguerre's method from below; see Backend.

        .. math:: \lambda^+ = \lambda + n / (s_1 + \sqrt{(n - 1)(n s_2 - s_1^2)}), \qquad
            s_k = \mathrm{tr} (A - \lambda)^{-k}

        All eigenvalues are real, so the iteration increases to the smallest one without passing it.
        """
        n, size = len(A), expression(np.trace(A))
        found = -1e-14 * size  # so that the inverse exists if the eigenvalue is 0
        for _ in range(_STEPS):
            inverse = Factors((A - found * np.eye(n)).tolist()).inverse()
            s_1 = sum(inverse[i][i] for i in range(n))
            s_2 = dot(*2 * [[entry for row in inverse for entry in row]])
            spread = self.maximum((n - 1.0) * (n * s_2 - s_1 * s_1), 0.0)
            step = n / (s_1 + sqrt(spread))
            ahead = both(less(0.0, s_1), less(0.0, step))  # else it has converged, up to rounding
            found = found + select(ahead, step, 0.0)
        return found

    def rotation_vector(self, R: Array) -> Array:
        """Return axis times angle; see Backend."""
        axis = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]  # times twice the sine
        squared = dot(axis, axis)
        twice = sqrt(squared)
        angle = angle_of(twice, np.trace(R) - 1.0)
        # At zero rotation the ratio tends to 1/2; smaller squares underflow.
        return np.asarray(as_array(scale(select(less(1e-300, squared), angle / twice, 0.5), axis)))

    def _inside(self, condition: Any, branch: Callable[[], Chosen]) -> Chosen:
        self._within.append(condition)
        try:
            return branch()
        finally:
            self._within.pop()

    def _watch(self, failed: Any, text: str) -> None:
        """Record a possible failure, under the conditions of the enclosing choices."""
        if text not in self.errors:
            self.errors.append(text)
        if self._within:
            failed = all_of([*self._within, failed])
        here = both(failed, equal(self.fault, 0.0))
        self.fault = select(here, float(self.errors.index(text) + 1), self.fault)


def _all_positive(factors: Factors) -> Any:
    return all_of([less(0.0, pivot) for pivot in factors.pivots])
