"""Jacobian formulas of the thesis evaluated as printed, and the truths of axes and velocities."""

import numpy as np

from runner.audit.model_truths import Dynamics, by_model
from runner.audit.truth import Elements, Symbols, Truth, Way, along, coordinates, derivative, jacobian_by_differences
from runner.base.arrays import FloatArray
from runner.studies.thesis.equations.truths.thesis_arms import MACRO, MINI, Arm
from runner.studies.thesis.equations.truths.thesis_kinematics import model_frame, tip_pose

# Axes of the joints: frame i lies on the axis of joint i+1.


def _axis(arm: Arm, frame: int) -> Truth:
    return Truth(
        lambda s: coordinates("Z", by_model(arm.model).jacobian(arm.q(s))[:, 3:, frame]),
        lambda s: coordinates("Z", arm.frame(frame, arm.q(s))[:, :3, 2]),
        ("angular Jacobian by Pinocchio", "z axis of the chain's frame"),
    )


macro_axis_0, macro_axis_1, macro_axis_2 = (_axis(MACRO, frame) for frame in range(3))
mini_axis_0, mini_axis_1, mini_axis_2 = (_axis(MINI, frame) for frame in range(3))
joint_axes = MACRO.both(lambda d, s: {f"Z_{i}": d.jacobian(MACRO.q(s))[:, 3:, i] for i in (1, 2)})


def axes_of_frames(s: Symbols) -> Elements:
    """Return 0R_i Z for frames 1 and 2, Z_i as section 3.1 defines it."""
    q = MACRO.q(s)
    return {f"Z_{i}": model_frame(MACRO, i, q)[:, :3, :3] @ np.array([0.0, 0.0, 1.0]) for i in (1, 2)}


def tip_column(s: Symbols) -> Elements:
    """Return the last column of T_03, section 3.3.1."""
    return coordinates("P", tip_pose(MACRO, MACRO.q(s))[:, :3, 3])


# Velocity.


def _velocity(arm: Arm, rows: slice) -> Truth:
    def by_motion(s: Symbols) -> Elements:
        q, dq, start = arm.q(s), arm.dq(s), np.zeros((len(s["q1"]), 1))
        return {"v": jacobian_by_differences(lambda time: tip_pose(arm, q + time * dq), start)[:, rows, 0]}

    def by_chain(d: Dynamics, s: Symbols) -> Elements:
        return {"v": along(d.jacobian(arm.q(s))[:, rows], arm.dq(s))}

    ways = ("Pinocchio's pose a moment before and after", "differences of the URDF's transforms")
    return Truth(by_motion, arm.both(by_chain).second, ways)


macro_twist = _velocity(MACRO, slice(0, 6))
macro_velocity, mini_velocity = _velocity(MACRO, slice(0, 3)), _velocity(MINI, slice(0, 3))


# The general formulas, on the Macro.


def _end_by_differences(link: int, q: FloatArray) -> FloatArray:
    return np.stack([derivative(lambda at: MACRO.frame(link, at)[:, :3, 3], q, joint) for joint in range(3)], axis=2)


def transposed(s: Symbols) -> Elements:
    """Return J_ij = dG_j / dq_i as printed before (3.4)."""
    return {"J": position_derivatives(s)["J"].transpose(0, 2, 1)}


def position_derivatives(s: Symbols) -> Elements:
    """Return dG_i / dq_j."""
    return {"J": _end_by_differences(3, MACRO.q(s))}


def end_by_differences(s: Symbols) -> Elements:
    """Return (3.13): derivatives of the position of the second link's end."""
    return {"J": _end_by_differences(2, MACRO.q(s))}


def _with_axes(first: int) -> Way:
    """Return (3.4) and (3.5) with the z axis of frame i - 1 + first as the angular part of column i."""

    def columns(s: Symbols) -> Elements:
        axes = [model_frame(MACRO, i + first, MACRO.q(s))[:, :3, 2] for i in range(3)]
        return {"J": np.concatenate([position_derivatives(s)["J"], np.stack(axes, axis=2)], axis=1)}

    return columns


with_joint_axes, with_following_axes = _with_axes(0), _with_axes(1)
"""The axis of joint i, which is right, and that of frame i, as printed."""


def _levers(shift: int, turned: bool = True) -> Way:
    """Return columns Z_{i-1} x P, P from the origin of frame i - 1 + shift to the tip, in the base frame or its own."""

    def columns(s: Symbols) -> Elements:
        q = MACRO.q(s)
        frames = [model_frame(MACRO, i, q) for i in range(4)]
        found = []
        for i in (1, 2, 3):
            start = frames[i - 1 + shift]
            lever = frames[3][:, :3, 3] - start[:, :3, 3]
            if not turned:
                lever = along(start[:, :3, :3].transpose(0, 2, 1), lever)  # the last column of iT_n
            found.append(np.cross(frames[i - 1][:, :3, 2], lever))
        return {"J": np.stack(found, axis=2)}

    return columns


levers_from_frame_i = _levers(1)
"""(3.6) as printed: P_in from the origin of frame i."""

levers_from_joint_i = _levers(0)
"""(3.6) with P from the origin of frame i-1, where joint i is."""

levers_not_turned = _levers(0, turned=False)
"""The link Jacobian of section 3.2 with P_ij as the last column of iT_j, which is expressed in frame i."""


def symbolic_columns(s: Symbols) -> Elements:
    """Return [Z_0 x P_0E ...; Z_0 ...] below (3.6): the columns that the thesis in fact uses."""
    axes = with_joint_axes(s)["J"][:, 3:]
    return {"J": np.concatenate([levers_from_joint_i(s)["J"], axes], axis=1)}


def _link_columns(arm: Arm, rows: slice, link: int) -> Way:
    return lambda s: {"J": arm.end_jacobian(link, arm.q(s))[:, rows]}


linear_columns_1, linear_columns_2, linear_columns_3 = (_link_columns(MACRO, slice(0, 3), link) for link in (1, 2, 3))
angular_columns_3 = _link_columns(MACRO, slice(3, 6), 3)
"""(3.14) and (3.15): Z_{i-1} x p and Z_{i-1}, and zeros behind the link."""

mini_symbolic_columns = _link_columns(MINI, slice(0, 6), 3)
"""(4.2)."""
