"""Truths of operational-space dynamics and control, sections 3.2 and 3.3 of the thesis, on the Macro.

With its three joints the linear Jacobian is square; the samples keep off its singular postures. The formulas are
carried out with M, V, G and J as the thesis prints them; the truth is the motion of the model, and of the chain.
"""

from collections.abc import Callable

import numpy as np

from runner.audit.chains import derivative
from runner.audit.truth import Elements, FloatArray, Symbols, Truth, Way
from runner.works.thesis.equations.truths import thesis_printed as printed
from runner.works.thesis.equations.truths.thesis_arms import MACRO, along
from runner.works.thesis.equations.truths.thesis_dynamics import (
    kinetic_mass_matrix,
    model_coriolis,
    model_gravity,
    model_mass_matrix,
)
from runner.works.thesis.equations.truths.thesis_jacobians import jacobian_by_chain, model_jacobian

_WAYS = ("Pinocchio", "d'Alembert's principle on the chain's point masses, rates by differences")
_K_P, _K_V = 30.0**2, 2.0 * 30.0  # 1/s^2, 1/s: omega_n = 30 rad/s, xi = 1, section 3.3.1
_GOAL = np.array([0.1679, -0.7571, 0.4255])  # m


def _transposed(matrices: FloatArray) -> FloatArray:
    return matrices.transpose(0, 2, 1)


def _solve(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.solve(matrices, vectors[..., None])[..., 0], dtype=float)


# The formulas with the thesis' own M, V, G and J.


def _inverse_jacobian(s: Symbols) -> FloatArray:
    return np.asarray(np.linalg.inv(printed.linear_jacobian(MACRO.q(s))), dtype=float)


def jacobian_rate(s: Symbols) -> Elements:
    """Return h by (3.30) and (3.31): the rate of J by differences, times dq."""
    q, dq = MACRO.q(s), MACRO.dq(s)

    def jacobian(time: FloatArray) -> FloatArray:
        return printed.linear_jacobian(q + time * dq)

    return {"h": along(derivative(jacobian, np.zeros((len(q), 1)), 0), dq)}


def kinetic_energy_matrix(s: Symbols) -> Elements:
    """Return Lambda by (3.27)."""
    inverse = _inverse_jacobian(s)
    return {"Lambda": _transposed(inverse) @ printed.mass_matrix(MACRO.q(s)) @ inverse}


def centrifugal_force(s: Symbols) -> Elements:
    """Return mu by (3.28)."""
    V = printed.coriolis_torque(MACRO.q(s), MACRO.dq(s))
    at_tip = along(_transposed(_inverse_jacobian(s)), V)
    return {"mu": at_tip - along(kinetic_energy_matrix(s)["Lambda"], jacobian_rate(s)["h"])}


def gravity_force(s: Symbols) -> Elements:
    """Return p by (3.29)."""
    return {"p": along(_transposed(_inverse_jacobian(s)), printed.gravity_torque(MACRO.q(s)))}


def _force(s: Symbols, acceleration: FloatArray) -> FloatArray:
    total: FloatArray = (
        along(kinetic_energy_matrix(s)["Lambda"], acceleration) + centrifugal_force(s)["mu"] + gravity_force(s)["p"]
    )
    return total


def end_effector_force(s: Symbols) -> Elements:
    """Return F by (3.26) for the motion of the sample."""
    q, ddq = MACRO.q(s), MACRO.ddq(s)
    return {"F": _force(s, along(printed.linear_jacobian(q), ddq) + jacobian_rate(s)["h"])}


# The truth.


def _model_bias(s: Symbols) -> FloatArray:
    model = MACRO.model()
    return np.array([model.tip_bias_acceleration(*row) for row in zip(MACRO.q(s), MACRO.dq(s), strict=True)])


def _chain_bias(s: Symbols) -> FloatArray:
    return MACRO.bias_acceleration(3, MACRO.q(s), MACRO.dq(s))


def _model_terms(s: Symbols) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return M, V, G, the linear J and its rate times dq by Pinocchio."""
    q, dq = MACRO.q(s), MACRO.dq(s)
    M, V, G = model_mass_matrix(MACRO, q), model_coriolis(MACRO, q, dq), model_gravity(MACRO, q)
    return M, V, G, model_jacobian(MACRO, q)[:, :3], _model_bias(s)


def _chain_terms(s: Symbols) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the same by the chain."""
    q, dq = MACRO.q(s), MACRO.dq(s)
    M, V, G = kinetic_mass_matrix(MACRO, q), MACRO.coriolis_torque(q, dq), MACRO.gravity_torque(q)
    return M, V, G, jacobian_by_chain(MACRO, q)[:, :3], _chain_bias(s)


def _truth(terms: Callable[[Symbols], tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]]) -> Way:
    """Return what the tip's motion asks for, found in joint space: the joints that give it, then their torques."""

    def found(s: Symbols) -> Elements:
        M, V, G, J, bias = terms(s)

        def torque(acceleration: FloatArray) -> FloatArray:
            return along(M, _solve(J, acceleration - bias)) + V

        def force(tau: FloatArray) -> FloatArray:
            return _solve(_transposed(J), tau)

        unit = np.eye(3)
        still = np.zeros((len(J), 3))
        return {
            "h": bias,
            "Lambda": np.stack([force(along(M, _solve(J, np.tile(e, (len(J), 1))))) for e in unit], axis=2),
            "mu": force(torque(still)),
            "p": force(G),
            "F": force(along(M, MACRO.ddq(s)) + V + G),
            "tau": torque(_input(s)) + G,
        }

    return found


operational = Truth(_truth(_model_terms), _truth(_chain_terms), _WAYS)


# Control: the tip's acceleration under the torques that a law gives.


def _input(s: Symbols) -> FloatArray:
    """Return any control input F*, shape (T, 3), in m/s^2."""
    return np.column_stack([s["ddq4"], s["ddq5"], s["ddq6"]])


def control_torque(s: Symbols) -> Elements:
    """Return J' F with F by (3.32)."""
    return {"tau": along(_transposed(printed.linear_jacobian(MACRO.q(s))), _force(s, _input(s)))}


def chosen_input(s: Symbols) -> Elements:
    """Return the tip's acceleration that the thesis derives: F* itself."""
    return {"acceleration": _input(s)}


def _state(s: Symbols) -> tuple[FloatArray, FloatArray]:
    q = MACRO.q(s)
    return MACRO.frame(3, q)[:, :3, 3], along(printed.linear_jacobian(q), MACRO.dq(s))


def _desired(s: Symbols) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return any desired position, velocity and acceleration of the tip."""
    return (
        np.column_stack([s["x_0"], s["x_t"], s["a"]]),
        np.column_stack([s["d"], s["dq4"], s["dq5"]]),
        _input(s),
    )


def goal_input(s: Symbols) -> FloatArray:
    """Return F* by (3.33)."""
    x, dx = _state(s)
    acceleration: FloatArray = -_K_V * dx - _K_P * (x - _GOAL)
    return acceleration


def tracking_input(s: Symbols) -> FloatArray:
    """Return F* by (3.40)."""
    (x, dx), (x_d, dx_d, ddx_d) = _state(s), _desired(s)
    acceleration: FloatArray = ddx_d - _K_V * (dx - dx_d) - _K_P * (x - x_d)
    return acceleration


def goal_acceleration(s: Symbols) -> Elements:
    """Return the tip's acceleration that the thesis derives for a goal: F* of (3.33)."""
    return {"acceleration": goal_input(s)}


def goal_loop(s: Symbols) -> Elements:
    """Return the second derivative of the error by (3.34), with the gains of (3.37) and (3.38)."""
    x, dx = _state(s)
    return {"acceleration": -_K_V * dx - _K_P * (x - _GOAL)}


def tracking_loop(s: Symbols) -> Elements:
    """Return the same by (3.41)."""
    (x, dx), (x_d, dx_d, _) = _state(s), _desired(s)
    return {"acceleration": -_K_V * (dx - dx_d) - _K_P * (x - x_d)}


def _closed(law: Callable[[Symbols], FloatArray], offset: Callable[[Symbols], FloatArray]) -> Truth:
    """Return the tip's acceleration, less the desired one, under the torques of (3.32) with a law's F*."""

    def torque(s: Symbols) -> FloatArray:
        return along(_transposed(printed.linear_jacobian(MACRO.q(s))), _force(s, law(s)))

    def by_model(s: Symbols) -> Elements:
        model = MACRO.model()
        rows = zip(MACRO.q(s), MACRO.dq(s), torque(s), strict=True)
        ddq = np.array([model.forward_dynamics(*row) for row in rows])
        J = model_jacobian(MACRO, MACRO.q(s))[:, :3]
        return {"acceleration": along(J, ddq) + _model_bias(s) - offset(s)}

    def by_chain(s: Symbols) -> Elements:
        M, V, G, J, bias = _chain_terms(s)
        return {"acceleration": along(J, _solve(M, torque(s) - V - G)) + bias - offset(s)}

    return Truth(by_model, by_chain, _WAYS)


def _none(s: Symbols) -> FloatArray:
    return 0.0 * _input(s)


any_closed = _closed(_input, _none)
goal_closed = _closed(goal_input, _none)
tracking_closed = _closed(tracking_input, lambda s: _desired(s)[2])
