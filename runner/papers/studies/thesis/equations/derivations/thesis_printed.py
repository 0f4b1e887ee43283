"""Matrices of both thesis arms, emended or corrected, read from the audit entries."""

from functools import lru_cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import along
from runner.papers.audit.entry import entries
from runner.papers.audit.evaluation import evaluate
from runner.papers.audit.model_derivations import by_model
from runner.papers.expressions.parser import ParsedExpression, parse
from runner.papers.studies.thesis.equations.derivations.thesis import symbols_at
from runner.robots.model import RobotModel

_OF_MINI = {"v_M": "v_m", "J_M": "J_m", "0TE": "3T6"}  # the others end in -mini


@lru_cache(maxsize=32)
def _expression(name: str) -> ParsedExpression:
    entry = next(entry for _, entry in entries("thesis") if entry.id == f"thesis-{name}")
    (text,) = entry.true_form.elements.values()
    return parse(text)


def _matrix(name: str, q: FloatArray, mini: bool = False) -> FloatArray:
    """Return the matrix or vector of an entry of the Macro, or the Mini's own, at the arm's joint positions (T, 3)."""
    found = _expression(_OF_MINI.get(name, f"{name}-mini") if mini else name)
    return evaluate(found, symbols_at(np.column_stack([0.0 * q, q]) if mini else q))


def mass_matrix(q: FloatArray, mini: bool = False) -> FloatArray:
    """Return M(q) below (3.17), shape (T, 3, 3)."""
    return _matrix("M", q, mini)


def linear_jacobian(q: FloatArray, mini: bool = False) -> FloatArray:
    """Return the linear Jacobian below (3.8), shape (T, 3, 3)."""
    return _matrix("v_M", q, mini)


def coriolis_torque(q: FloatArray, dq: FloatArray, mini: bool = False) -> FloatArray:
    """Return V by (3.19) with B(q) and C(q) below (3.23), shape (T, 3)."""
    dq1, dq2, dq3 = dq.T
    products = np.column_stack([dq1 * dq2, dq1 * dq3, dq2 * dq3])
    return along(_matrix("C", q, mini), dq**2) + along(_matrix("B", q, mini), products)


def gravity_torque(q: FloatArray, mini: bool = False) -> FloatArray:
    """Return G(q) below (3.24), shape (T, 3)."""
    return _matrix("G", q, mini)


def compare(model: RobotModel, mini: bool, samples: int, generator: np.random.Generator) -> dict[str, float]:
    """Return the largest differences of M, V, G, J and the tip's transform T from those of an arm's model, by symbol.

    The states are random, positions within +-pi rad and velocities within +-1 rad/s.
    """
    q, dq = generator.uniform(-np.pi, np.pi, (samples, 3)), generator.uniform(-1.0, 1.0, (samples, 3))
    arm = by_model(model)
    differences = {
        "M": mass_matrix(q, mini) - arm.mass_matrix(q),
        "V": coriolis_torque(q, dq, mini) - arm.velocity_torque(q, dq[None])[0],
        "G": gravity_torque(q, mini) - arm.gravity(q),
        "J": _matrix("J_M", q, mini) - arm.jacobian(q),
        "T": _matrix("0TE", q, mini) - arm.pose(q),
    }
    return {symbol: float(np.abs(difference).max()) for symbol, difference in differences.items()}
