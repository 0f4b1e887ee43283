"""Reference derivations of operational-space dynamics and control, sections 3.2 and 3.3 of the thesis, on the Macro.

With its three joints the linear Jacobian is square; the samples exclude its singular configurations. The formulas are
evaluated with M, V, G and J as printed in the thesis; the true values are the motion of the model, and of the chain.
"""

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Derivations, Elements, Symbols, along, columns, derivative
from runner.papers.audit.entry import parts, right_elements
from runner.papers.audit.evaluation import SampleValues
from runner.papers.audit.model_derivations import Dynamics, by_model, by_urdf
from runner.papers.studies.thesis.equations.derivations import thesis_printed as printed
from runner.papers.studies.thesis.equations.derivations.thesis import regular_symbols
from runner.papers.studies.thesis.equations.derivations.thesis_arms import MACRO

_METHODS = ("Pinocchio", "energies of the URDF's bodies, rates by differences")
_K_P, _K_V = 30.0**2, 2.0 * 30.0  # 1/s^2, 1/s: omega_n = 30 rad/s, xi = 1, section 3.3.1
_GOAL = np.array([0.1679, -0.7571, 0.4255])  # m


def _transposed(matrices: FloatArray) -> FloatArray:
    return matrices.transpose(0, 2, 1)


def _solve(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.solve(matrices, vectors[..., None])[..., 0], dtype=float)


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random states as `thesis.regular_symbols` does, with the vectors and matrices of the Macro.

    `J` is its linear Jacobian, `dJ` the Jacobian's rate by differences, `M`, `V` and `G` those of its dynamics, all as
    the thesis prints them. The tip is at `x`, with the rates `dx` and `ddx`; `x_g` is a goal, `F_star` a control input.
    `x_d`, `dx_d` and `ddx_d` are a desired motion; `deps` and `deps_d` are the rates of the two errors.
    """
    s = regular_symbols(count, generator)
    q, dq, ddq = MACRO.q(s), MACRO.dq(s), MACRO.ddq(s)

    def jacobian(time: FloatArray) -> FloatArray:
        return printed.linear_jacobian(q + time * dq)

    J, dJ = jacobian(np.zeros((count, 1))), derivative(jacobian, np.zeros((count, 1)), 0)
    tip = {"x": MACRO.frame(3, q)[:, :3, 3], "dx": along(J, dq), "ddx": along(J, ddq) + along(dJ, dq)}
    goal = {"x_g": np.tile(_GOAL, (count, 1)), "k_p": np.full(count, _K_P), "k_v": np.full(count, _K_V)}
    arm = {"M": printed.mass_matrix(q), "V": printed.coriolis_torque(q, dq), "G": printed.gravity_torque(q)}
    desired = {"x_d": columns(s, ("x_0", "x_t", "a")), "dx_d": columns(s, ("d", "dq4", "dq5")), "ddx_d": _input(s)}
    rates = {"deps": tip["dx"], "deps_d": tip["dx"] - desired["dx_d"], "T_03": MACRO.frame(3, q)}
    return {**s, "J": J, "dJ": dJ, "dq": dq, **arm, **tip, **goal, **desired, **rates, "F_star": _input(s)}


# The motion of the tip.


def _model_bias(s: Symbols) -> FloatArray:
    rows = zip(MACRO.q(s), MACRO.dq(s), strict=True)
    return np.array([MACRO.model.tip_bias_acceleration(*row) for row in rows])


def _chain_bias(s: Symbols) -> FloatArray:
    return MACRO.bias_acceleration(3, MACRO.q(s), MACRO.dq(s))


def _of_motion(d: Dynamics, bias: FloatArray, s: Symbols) -> Elements:
    """Return the terms of the tip's motion, found in joint space: the joints' motion, then their torques."""
    q, dq = MACRO.q(s), MACRO.dq(s)
    M, V, G, J = d.mass_matrix(q), d.velocity_torque(q, dq[None])[0], d.gravity(q), d.jacobian(q)[:, :3]

    def torque(acceleration: FloatArray) -> FloatArray:
        return np.asarray(along(M, _solve(J, acceleration - bias)) + V)

    def force(tau: FloatArray) -> FloatArray:
        return _solve(_transposed(J), tau)

    columns = [force(along(M, _solve(J, np.tile(e, (len(J), 1))))) for e in np.eye(3)]
    return {
        "h": bias,
        "Lambda": np.stack(columns, axis=2),
        "mu": force(torque(0.0 * bias)),
        "p": force(G),
        "F": force(along(M, MACRO.ddq(s)) + V + G),
        "tau": torque(_input(s)) + G,
    }


_PINOCCHIO, _URDF = by_model(MACRO.model), by_urdf(MACRO.audited.urdf, MACRO.model)
operational = Derivations(
    lambda s: _of_motion(_PINOCCHIO, _model_bias(s), s), lambda s: _of_motion(_URDF, _chain_bias(s), s), _METHODS
)


# Control: the tip's acceleration under the torques that a law gives.


def _input(s: Symbols) -> FloatArray:
    """Return any control input F*, shape (T, 3), in m/s^2."""
    return columns(s, ("ddq4", "ddq5", "ddq6"))


def _closed(control_input: str, desired: str = "") -> Derivations:
    """Return the tip's acceleration under the torques J' F with F by (3.32) for one of the names F* in 3_3.yaml.

    `ddeps`, or `ddeps_d` if it tracks a motion, is the same less the desired one.
    """

    def torque(s: Symbols) -> FloatArray:
        known = right_elements(next(part for part in parts("thesis") if part.path.name == "3_3.yaml"))
        wanted = SampleValues(s, known)[control_input]
        return SampleValues({**s, "F_star": wanted}, known)["tau"]

    def named(acceleration: FloatArray, s: Symbols) -> Elements:
        return {"ddx": acceleration, "ddeps_d" if desired else "ddeps": acceleration - (s[desired] if desired else 0.0)}

    def by_pinocchio(s: Symbols) -> Elements:
        q, dq = MACRO.q(s), MACRO.dq(s)
        rows = zip(q, dq, torque(s), strict=True)
        ddq = np.array([MACRO.model.forward_dynamics(*row) for row in rows])
        return named(along(_PINOCCHIO.jacobian(q)[:, :3], ddq) + _model_bias(s), s)

    def by_energies(s: Symbols) -> Elements:
        q, dq = MACRO.q(s), MACRO.dq(s)
        free = torque(s) - _URDF.torque(q, dq, 0.0 * q)
        motion = along(_URDF.jacobian(q)[:, :3], _solve(_URDF.mass_matrix(q), free))
        return named(motion + _chain_bias(s), s)

    return Derivations(by_pinocchio, by_energies, _METHODS)


any_closed, goal_closed, tracking_closed = _closed("F_star"), _closed("F_goal"), _closed("F_track", "ddx_d")
