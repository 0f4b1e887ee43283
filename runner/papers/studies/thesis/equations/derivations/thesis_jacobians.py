"""Reference derivations of axes and velocities of the thesis, and the symbols of its general formulas."""

from functools import partial

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.derivations import (
    Derivations,
    Elements,
    Symbols,
    along,
    derivative,
    elements,
    jacobian_by_differences,
)
from runner.papers.audit.model_derivations import Dynamics, by_model
from runner.papers.studies.thesis.equations.derivations import thesis_measures
from runner.papers.studies.thesis.equations.derivations.thesis_arms import MACRO, MINI, ThesisArm
from runner.papers.studies.thesis.equations.derivations.thesis_inertia import tensor_symbols
from runner.papers.studies.thesis.equations.derivations.thesis_kinematics import model_frame, tip_pose

# Axes of the joints: frame i lies on the axis of joint i+1.


def _axis(arm: ThesisArm, frame: int) -> Derivations:
    name = f"Z_{arm.joints.start + frame}"
    return Derivations(
        lambda s: {name: by_model(arm.model).jacobian(arm.q(s))[:, 3:, frame]},
        lambda s: {name: arm.frame(frame, arm.q(s))[:, :3, 2]},
        ("angular Jacobian by Pinocchio", "z axis of the chain's frame"),
    )


macro_axis_0, macro_axis_1, macro_axis_2 = (_axis(MACRO, frame) for frame in range(3))
mini_axis_0, mini_axis_1, mini_axis_2 = (_axis(MINI, frame) for frame in range(3))
joint_axes = MACRO.both(lambda d, s: {f"Z_{i}": d.jacobian(MACRO.q(s))[:, 3:, i] for i in (1, 2)})


# Velocity.


def _velocity(arm: ThesisArm, rows: slice) -> Derivations:
    def by_motion(s: Symbols) -> Elements:
        q, dq, start = arm.q(s), arm.dq(s), np.zeros((len(s["q1"]), 1))
        return {"v": jacobian_by_differences(lambda time: tip_pose(arm, q + time * dq), start)[:, rows, 0]}

    def by_chain(d: Dynamics, s: Symbols) -> Elements:
        return {"v": along(d.jacobian(arm.q(s))[:, rows], arm.dq(s))}

    methods = ("Pinocchio's pose a moment before and after", "differences of the URDF's transforms")
    return Derivations(by_motion, arm.both(by_chain).second, methods)


macro_twist = _velocity(MACRO, slice(0, 6))
macro_velocity, mini_velocity = _velocity(MACRO, slice(0, 3)), _velocity(MINI, slice(0, 3))


# The symbols of the general formulas.


def frame_symbols(arm: ThesisArm, q: FloatArray) -> dict[str, FloatArray]:
    """Return axes `Z_i`, rotations `R_i` and vectors `P_ij` from origin to origin; E and n are frame 3 of the Macro."""
    frames = {str(i + arm.joints.start): model_frame(arm, i, q) for i in range(4)}
    ends = [*frames.items(), ("E", frames[str(arm.joints.stop)]), ("n", frames[str(arm.joints.stop)])]
    values = {f"Z_{i}": frame[:, :3, 2] for i, frame in frames.items()}
    values |= {f"R_{i}": frame[:, :3, :3] for i, frame in frames.items()}
    return values | {f"P_{i}{j}": end[:, :3, 3] - start[:, :3, 3] for i, start in frames.items() for j, end in ends}


def _jacobian_symbols(arm: ThesisArm, q: FloatArray) -> dict[str, FloatArray]:
    """Return the linear and angular Jacobians `J_v_i` and `J_w_i` of the end of each link."""
    found = {i: arm.end_jacobian(i, q) for i in (1, 2, 3)}
    first = arm.joints.start
    return {f"J_v_{i + first}": J[:, :3] for i, J in found.items()} | {
        f"J_w_{i + first}": J[:, 3:] for i, J in found.items()
    }


def macro_symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random states as `thesis_measures.symbols` does, with what the general formulas are for the Macro.

    `dG_ij` is the derivative of coordinate i of the tip with respect to joint j, `dx_j` that of the tip, and `dpi_j`
    that of the end of link i. `eps_i` is 1 for a revolute joint. For the others see `frame_symbols`.
    """
    s = thesis_measures.symbols(count, generator)
    q = MACRO.q(s)
    found = frame_symbols(MACRO, q) | _jacobian_symbols(MACRO, q) | {f"eps_{i}": np.ones(count) for i in (1, 2, 3)}
    columns: list[FloatArray] = []
    for link in (1, 2, 3):
        columns = [derivative(partial(_end, link), q, joint) for joint in range(3)]
        found |= {f"dp{link}_{joint}": each for joint, each in enumerate(columns, start=1)}
    found |= {f"dx_{joint}": each for joint, each in enumerate(columns, start=1)}
    return {**s, **found, **elements("dG", np.stack(columns, axis=2))}


def _end(link: int, q: FloatArray) -> FloatArray:
    return MACRO.frame(link, q)[:, :3, 3]


def mini_symbols(count: int, generator: np.random.Generator) -> Symbols:
    """Return random states as `thesis_measures.symbols` does, with what the general formulas are for the Mini.

    `m_i` are the masses and `L_i` the lengths of the links. For the others see `frame_symbols` and `tensor_symbols`.
    """
    s = thesis_measures.symbols(count, generator)
    measures = {f"m_{i}": np.full(count, MINI.masses[i - 4]) for i in (4, 5, 6)}
    measures |= {f"L_{i}": np.full(count, MINI.a[i - 4]) for i in (4, 5, 6)}
    q = MINI.q(s)
    return {**s, **frame_symbols(MINI, q), **_jacobian_symbols(MINI, q), **tensor_symbols(MINI, q), **measures}
