"""What the Macro's joints carry while the Mini holds still, section 5.3.1 of the thesis."""

import numpy as np

from runner.audit.truth import Elements, FloatArray, Symbols, Truth
from runner.works.thesis.equations.truths.thesis_arms import COMBINED, MACRO, Arm, along
from runner.works.thesis.equations.truths.thesis_dynamics import model_coriolis, model_gravity, model_mass_matrix


def _held(values: FloatArray) -> FloatArray:
    return np.column_stack([values[:, :3], np.zeros((len(values), 3))])


def _by_chain(arm: Arm, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
    torque: FloatArray = along(arm.mass_matrix(q), ddq) + arm.coriolis_torque(q, dq) + arm.gravity_torque(q)
    return torque


def alone(s: Symbols) -> Elements:
    """Return the torques of the Macro moving alone."""
    return {"tau": _by_chain(MACRO, MACRO.q(s), MACRO.dq(s), MACRO.ddq(s))}


def with_masses(s: Symbols) -> Elements:
    """Return the same with what the Mini's masses ask for, each at its place beyond the Macro's end."""
    q, dq, ddq = COMBINED.q(s), _held(COMBINED.dq(s)), _held(COMBINED.ddq(s))
    carried = np.zeros((len(q), 3))
    for link in (5, 6):
        J = COMBINED.end_jacobian(link, q)[:, :3]
        acceleration = along(J, ddq) + COMBINED.bias_acceleration(link, q, dq) + np.array([0.0, 0.0, 9.81])
        carried += COMBINED.masses[link - 1] * along(J.transpose(0, 2, 1), acceleration)[:, :3]
    return {"tau": alone(s)["tau"] + carried}


def _by_model(s: Symbols) -> Elements:
    q, dq, ddq = COMBINED.q(s), _held(COMBINED.dq(s)), _held(COMBINED.ddq(s))
    inertia = along(model_mass_matrix(COMBINED, q), ddq)
    return {"tau": (inertia + model_coriolis(COMBINED, q, dq) + model_gravity(COMBINED, q))[:, :3]}


def _by_masses(s: Symbols) -> Elements:
    q, dq, ddq = COMBINED.q(s), _held(COMBINED.dq(s)), _held(COMBINED.ddq(s))
    return {"tau": _by_chain(COMBINED, q, dq, ddq)[:, :3]}


mini_held = Truth(
    _by_model,
    _by_masses,
    ("Pinocchio, the six-joint arm", "d'Alembert's principle on all point masses, rates by differences"),
)
