"""Joint-space dynamics formulas of the thesis evaluated as printed, on the Macro and the combined arm."""

from collections.abc import Callable
from itertools import combinations

import numpy as np

from runner.audit.model_truths import by_model
from runner.audit.truth import Elements, Symbols, along, derivative
from runner.base.arrays import FloatArray
from runner.studies.thesis.equations.truths import thesis_printed as printed
from runner.studies.thesis.equations.truths.thesis_arms import COMBINED, GRAVITY, MACRO


def _rate(function: Callable[[FloatArray], FloatArray], q: FloatArray, dq: FloatArray) -> FloatArray:
    """Return a matrix function's rate along dq by differences."""
    return np.asarray(np.sum([dq[:, k, None, None] * derivative(function, q, k) for k in range(q.shape[1])], axis=0))


def velocity_terms(s: Symbols) -> Elements:
    """Return V by (3.12): the rate of M times dq, minus half the derivatives of dq' M dq."""
    q, dq = MACRO.q(s), MACRO.dq(s)
    squares = [np.einsum("ti,tij,tj->t", dq, derivative(printed.mass_matrix, q, k), dq) for k in range(3)]
    return {"V": along(_rate(printed.mass_matrix, q, dq), dq) - 0.5 * np.column_stack(squares)}


def lagrange(s: Symbols) -> Elements:
    """Return tau by (3.9): d/dt dK/d(dq) - dK/dq + G, with K = dq' M dq / 2."""
    inertia = along(printed.mass_matrix(MACRO.q(s)), MACRO.ddq(s))
    return {"tau": inertia + velocity_terms(s)["V"] + by_model(MACRO.model).gravity(MACRO.q(s))}


def printed_motion(s: Symbols) -> Elements:
    """Return tau by (3.10) and (3.25) with M, V and G of the thesis."""
    q, dq = MACRO.q(s), MACRO.dq(s)
    inertia = along(printed.mass_matrix(q), MACRO.ddq(s))
    return {"tau": inertia + printed.coriolis_torque(q, dq) + printed.gravity_torque(q)}


def _christoffel(q: FloatArray) -> FloatArray:
    """Return b_ijk = (m_ijk + m_ikj - m_jki) / 2, m_ijk = dm_ij / dq_k, shape (T, n, n, n)."""
    m = np.stack([derivative(printed.mass_matrix, q, k) for k in range(3)], axis=3)
    return 0.5 * (m + m.transpose(0, 1, 3, 2) - m.transpose(0, 3, 1, 2))


def by_christoffel(s: Symbols) -> Elements:
    """Return V with the Christoffel symbols above (3.18)."""
    dq = MACRO.dq(s)
    return {"V": np.einsum("tijk,tj,tk->ti", _christoffel(MACRO.q(s)), dq, dq)}


def christoffel_products(s: Symbols) -> Elements:
    """Return B by (3.20)."""
    b = _christoffel(MACRO.q(s))
    return {"B": 2.0 * np.stack([b[:, :, i, j] for i, j in combinations(range(3), 2)], axis=2)}


def christoffel_squares(s: Symbols) -> Elements:
    """Return C by (3.21)."""
    b = _christoffel(MACRO.q(s))
    return {"C": np.stack([b[:, :, i, i] for i in range(3)], axis=2)}


def squares_and_products(s: Symbols) -> Elements:
    """Return V by (3.19) with B and C of the thesis."""
    return {"V": printed.coriolis_torque(MACRO.q(s), MACRO.dq(s))}


def weights(s: Symbols) -> Elements:
    """Return G by (3.24): minus the sum of J_v' m g."""
    return {"G": MACRO.weight(MACRO.q(s))}


def point_masses(s: Symbols) -> Elements:
    """Return M by (3.17): the sum of m J_v' J_v."""
    Js = [MACRO.end_jacobian(link, MACRO.q(s))[:, :3] for link in (2, 3)]
    return {"M": np.sum([J.transpose(0, 2, 1) @ J for J in Js], axis=0)}  # of 1 kg each


# What the Macro's joints carry while the Mini holds still, section 5.3.1.


def alone(s: Symbols) -> Elements:
    """Return the torques of the Macro moving alone."""
    return {"tau": by_model(MACRO.model).torque(MACRO.q(s), MACRO.dq(s), MACRO.ddq(s))}


def with_masses(s: Symbols) -> Elements:
    """Return the same with what the Mini's masses ask for, each at its place beyond the Macro's end."""
    q, dq, ddq = COMBINED.q(s), _held(COMBINED.dq(s)), _held(COMBINED.ddq(s))
    carried = np.zeros((len(q), 3))
    for link in (5, 6):
        J = COMBINED.end_jacobian(link, q)[:, :3]
        acceleration = along(J, ddq) + COMBINED.bias_acceleration(link, q, dq) - GRAVITY
        carried += COMBINED.masses[link - 1] * along(J.transpose(0, 2, 1), acceleration)[:, :3]
    return {"tau": alone(s)["tau"] + carried}


def _held(values: FloatArray) -> FloatArray:
    return np.column_stack([values[:, :3], np.zeros((len(values), 3))])


mini_held = COMBINED.both(
    lambda d, s: {"tau": d.torque(COMBINED.q(s), _held(COMBINED.dq(s)), _held(COMBINED.ddq(s)))[:, :3]}
)
