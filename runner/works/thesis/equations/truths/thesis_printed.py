"""The Macro's matrices as the thesis means them, repaired or corrected, read from the audit's own entries."""

from functools import lru_cache

import numpy as np

from runner.audit.entry import entries
from runner.audit.evaluation import evaluate
from runner.audit.expressions import Expression, parse
from runner.audit.truth import FloatArray
from runner.works.thesis.equations.truths.thesis import symbols_at
from runner.works.thesis.equations.truths.thesis_arms import along


@lru_cache(maxsize=16)
def _expressions(name: str) -> dict[str, Expression]:
    entry = next(entry for _, entry in entries("thesis") if entry.id == f"thesis-{name}")
    form = entry.corrected or entry.repair or entry.printed
    return {element: parse(text) for element, text in form.elements.items()}


def _values(name: str, q: FloatArray) -> FloatArray:
    """Return an entry's elements in their order at the Macro's joint positions (T, 3), shape (elements, T)."""
    names = symbols_at(q)
    return np.array([evaluate(expression, names) for expression in _expressions(name).values()])


def _matrix(name: str, q: FloatArray) -> FloatArray:
    return _values(name, q).reshape(3, 3, -1).transpose(2, 0, 1)


def mass_matrix(q: FloatArray) -> FloatArray:
    """Return M(q) below (3.17), shape (T, 3, 3)."""
    return _matrix("M", q)


def linear_jacobian(q: FloatArray) -> FloatArray:
    """Return the linear Jacobian below (3.8), shape (T, 3, 3)."""
    return _matrix("v_M", q)


def coriolis_torque(q: FloatArray, dq: FloatArray) -> FloatArray:
    """Return V by (3.19) with B(q) and C(q) below (3.23), shape (T, 3)."""
    dq1, dq2, dq3 = dq.T
    products = np.column_stack([dq1 * dq2, dq1 * dq3, dq2 * dq3])
    return along(_matrix("C", q), dq**2) + along(_matrix("B", q), products)


def gravity_torque(q: FloatArray) -> FloatArray:
    """Return G(q) below (3.24), shape (T, 3)."""
    return _values("G", q).T
