"""Truths of the thesis' dynamics in joint space, and its general formulas carried out as printed.

The first way is Pinocchio; the second the point masses on the chain of elementary turns and shifts, by d'Alembert's
principle: what each mass's acceleration and weight ask of the joints.
"""

from collections.abc import Callable
from itertools import combinations

import numpy as np

from runner.audit.chains import derivative, jacobian_by_differences
from runner.audit.truth import Elements, FloatArray, Symbols, Truth
from runner.works.thesis.equations.truths import thesis_printed as printed
from runner.works.thesis.equations.truths.thesis import elements
from runner.works.thesis.equations.truths.thesis_arms import MACRO, MINI, Arm, along
from runner.works.thesis.equations.truths.thesis_jacobians import model_jacobian

WAYS = ("Pinocchio", "d'Alembert's principle on the chain's point masses, rates by differences")
Torque = Callable[[FloatArray], FloatArray]


# Pinocchio over many samples.


def model_mass_matrix(arm: Arm, q: FloatArray) -> FloatArray:
    """Return M(q) by Pinocchio, shape (T, n, n)."""
    model = arm.model()
    return np.array([model.mass_matrix(row) for row in q])


def model_coriolis(arm: Arm, q: FloatArray, dq: FloatArray) -> FloatArray:
    """Return V(q, dq) by Pinocchio, shape (T, n)."""
    model = arm.model()
    return np.array([model.coriolis_torque(*row) for row in zip(q, dq, strict=True)])


def model_gravity(arm: Arm, q: FloatArray) -> FloatArray:
    """Return G(q) by Pinocchio, shape (T, n)."""
    model = arm.model()
    return np.array([model.gravity_torque(row) for row in q])


# M, V, B, C, G and the torque.


def kinetic_mass_matrix(arm: Arm, q: FloatArray) -> FloatArray:
    """Return M(q) from the kinetic energy at unit velocities, the masses' velocities by differences, (T, n, n)."""
    ends = [np.sqrt(m) * _end_by_differences(arm, i, q) for i, m in enumerate(arm.masses, start=1)]

    def energy(dq: FloatArray) -> FloatArray:
        total: FloatArray = sum(0.5 * ((J @ dq) ** 2).sum(axis=1) for J in ends)
        return total

    unit = np.eye(q.shape[1])
    rows = [[energy(e_i + e_j) - energy(e_i) - energy(e_j) for e_j in unit] for e_i in unit]
    return np.moveaxis(np.array(rows), -1, 0)


def _end_by_differences(arm: Arm, link: int, q: FloatArray) -> FloatArray:
    return jacobian_by_differences(lambda at: arm.frame(link, at), q)[:, :3]


def _squares_and_products(V: Callable[[FloatArray], FloatArray], count: int) -> tuple[FloatArray, FloatArray]:
    """Return C and B of V = C [dq^2] + B [dq dq] from V at unit velocities, shapes (T, n, n), (T, n, n(n-1)/2)."""
    unit = np.eye(count)
    squares = [V(e) for e in unit]
    products = [V(unit[i] + unit[j]) - squares[i] - squares[j] for i, j in combinations(range(count), 2)]
    return np.stack(squares, axis=2), np.stack(products, axis=2)


def _motion(arm: Arm) -> Truth:
    """Return M, C, B, G, V and tau of an arm, whole and element by element."""

    def first(s: Symbols) -> Elements:
        q, dq = arm.q(s), arm.dq(s)
        C, B = _squares_and_products(lambda unit: model_coriolis(arm, q, np.tile(unit, (len(q), 1))), 3)
        return _named(s, arm, model_mass_matrix(arm, q), C, B, model_coriolis(arm, q, dq), model_gravity(arm, q))

    def second(s: Symbols) -> Elements:
        q, dq = arm.q(s), arm.dq(s)
        C, B = _squares_and_products(lambda unit: arm.coriolis_torque(q, np.tile(unit, (len(q), 1))), 3)
        V, G = arm.coriolis_torque(q, dq), arm.gravity_torque(q)
        return _named(s, arm, kinetic_mass_matrix(arm, q), C, B, V, G)

    return Truth(first, second, WAYS)


def _named(
    s: Symbols, arm: Arm, M: FloatArray, C: FloatArray, B: FloatArray, V: FloatArray, G: FloatArray
) -> dict[str, FloatArray]:
    whole = {"M": M, "C": C, "B": B, "V": V, "G": G, "tau": along(M, arm.ddq(s)) + V + G}
    return whole | {name: v for key in "MCBG" for name, v in elements(key, whole[key]).items()}


macro_motion, mini_motion = _motion(MACRO), _motion(MINI)


# The general formulas, on the Macro.


def _rate(function: Torque, q: FloatArray, dq: FloatArray) -> FloatArray:
    """Return a matrix function's rate along dq by differences."""
    total: FloatArray = np.asarray(
        sum(dq[:, k, None, None] * derivative(function, q, k) for k in range(q.shape[1])), dtype=float
    )
    return total


def velocity_terms(s: Symbols) -> Elements:
    """Return V by (3.12): the rate of M times dq, minus half the derivatives of dq' M dq."""
    q, dq = MACRO.q(s), MACRO.dq(s)
    squares = [np.einsum("ti,tij,tj->t", dq, derivative(printed.mass_matrix, q, k), dq) for k in range(3)]
    return {"V": along(_rate(printed.mass_matrix, q, dq), dq) - 0.5 * np.column_stack(squares)}


def lagrange(s: Symbols) -> Elements:
    """Return tau by (3.9): d/dt dK/d(dq) - dK/dq + G, with K = dq' M dq / 2."""
    inertia = along(printed.mass_matrix(MACRO.q(s)), MACRO.ddq(s))
    return {"tau": inertia + velocity_terms(s)["V"] + model_gravity(MACRO, MACRO.q(s))}


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
    q, g = MACRO.q(s), np.array([0.0, 0.0, -9.81])
    ends = ((0.0, "q2"), (1.0, "q3"), (1.0, "tip"))
    return {"G": -sum((model_jacobian(MACRO, q, end)[:, :3].transpose(0, 2, 1) @ (m * g) for m, end in ends), 0.0 * q)}


def point_masses(s: Symbols) -> Elements:
    """Return M by (3.17): the sum of m J_v' J_v."""
    return {"M": MACRO.mass_matrix(MACRO.q(s))}
