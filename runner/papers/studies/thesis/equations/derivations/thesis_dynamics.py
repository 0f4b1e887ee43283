"""Symbols of the joint-space dynamics of the thesis, and derivations for a Mini held still."""

from itertools import combinations

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import Symbols, along, derivative, elements
from runner.papers.audit.model_derivations import by_model
from runner.papers.studies.thesis.equations.derivations import thesis_measures
from runner.papers.studies.thesis.equations.derivations import thesis_printed as printed
from runner.papers.studies.thesis.equations.derivations.thesis_arms import COMBINED, GRAVITY, MACRO
from runner.papers.studies.thesis.equations.derivations.thesis_inertia import tensor_symbols
from runner.papers.studies.thesis.equations.derivations.thesis_jacobians import macro_symbols


def symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random states as `thesis_jacobians.macro_symbols` does, with what the dynamics of the Macro needs.

    `dM` is the rate of M along `dq`, `dM_k` its derivative with respect to joint k and `m_ijk` the elements of that.
    `dp` is the rate of the derivative of the kinetic energy with respect to `dq`, `dK` its derivative with respect to
    q. `squares` and `products` are those of `dq`, `p_12`, `p_22` vectors to the end of link 2, `last_ij` the last
    column of the transform from frame j to frame i.
    """
    s = macro_symbols(count, generator)
    q, dq, ddq = MACRO.q(s), MACRO.dq(s), MACRO.ddq(s)
    dM = [derivative(printed.mass_matrix, q, k) for k in range(3)]
    rate = np.sum([dq[:, k, None, None] * dM[k] for k in range(3)], axis=0)
    dK = 0.5 * np.column_stack([np.einsum("ti,tij,tj->t", dq, each, dq) for each in dM])
    motion = {"dq": dq, "ddq": ddq, "squares": dq**2, **{f"dq_{i + 1}": dq[:, i] for i in range(3)}}
    motion["products"] = np.column_stack([dq[:, i] * dq[:, j] for i, j in combinations(range(3), 2)])
    energy = {"dM": rate, "dK": dK, "dp": along(printed.mass_matrix(q), ddq) + along(rate, dq)}
    energy |= {f"dM_{k + 1}": each for k, each in enumerate(dM)} | elements("m", np.stack(dM, axis=3))
    levers = {"p_12": s["P_02"], "p_22": s["P_12"]}
    levers |= {f"last_{i}3": along(s[f"R_{i}"].transpose(0, 2, 1), s[f"P_{i}3"]) for i in range(3)}
    return {**s, **motion, **energy, **levers, **tensor_symbols(MACRO, q)}


# Torques of the Macro's joints while the Mini holds still, section 5.3.1.


def combined_symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random states as `thesis_measures.symbols` does, with the masses of a Mini that holds still.

    `J_v_i` is the Jacobian of mass `m_i` with respect to the Macro's joints, `ddx_i` its acceleration, `g` gravity.
    `tau_M` is the torque of the Macro by itself.
    """
    s = thesis_measures.symbols(count, generator)
    q, dq, ddq = COMBINED.q(s), _held(COMBINED.dq(s)), _held(COMBINED.ddq(s))
    found = {"tau_M": by_model(MACRO.model).torque(MACRO.q(s), MACRO.dq(s), MACRO.ddq(s))}
    for link in (5, 6):
        J = COMBINED.end_jacobian(link, q)[:, :3]
        found |= {f"J_v_{link}": J[:, :, :3], f"m_{link}": np.full(count, COMBINED.masses[link - 1])}
        found[f"ddx_{link}"] = along(J, ddq) + COMBINED.bias_acceleration(link, q, dq)
    return {**s, **found, "g": np.tile(GRAVITY, (count, 1))}


def _held(values: FloatArray) -> FloatArray:
    return np.column_stack([values[:, :3], np.zeros((len(values), 3))])


mini_held = COMBINED.both(
    lambda d, s: {"tau": d.torque(COMBINED.q(s), _held(COMBINED.dq(s)), _held(COMBINED.ddq(s)))[:, :3]}
)
