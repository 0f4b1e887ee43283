"""Truths of the thesis' Jacobians, and its general formulas for them carried out as printed.

The first way is Pinocchio; the second takes differences of the pose of a chain of elementary turns and shifts.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from runner.audit.chains import derivative, jacobian_by_differences
from runner.audit.truth import Elements, FloatArray, Symbols, Truth, Way
from runner.robots.model import RobotModel
from runner.works.thesis.equations.truths.thesis import coordinates, whole_and_elements
from runner.works.thesis.equations.truths.thesis_arms import MACRO, MINI, Arm, along, combined_robot
from runner.works.thesis.equations.truths.thesis_kinematics import WAYS, model_frame, tip_pose

_JACOBIAN_WAYS = ("Pinocchio", "differences of the chain's pose")


@lru_cache(maxsize=16)
def _model_of(arm: Arm, frame: str) -> RobotModel:
    """Return an arm's model whose tip is another of its frames."""
    return RobotModel(combined_robot().stages[0 if arm is MACRO else 1].urdf, frame)


def model_jacobian(arm: Arm, q: FloatArray, frame: str = "tip") -> FloatArray:
    """Return the basic Jacobians of a frame by Pinocchio, shape (T, 6, 3)."""
    model = _model_of(arm, frame)
    return np.array([model.tip_jacobian(row) for row in q])


def jacobian_by_chain(arm: Arm, q: FloatArray, link: int = 3) -> FloatArray:
    """Return the basic Jacobians of frame i = link by differences, shape (T, 6, 3)."""
    return jacobian_by_differences(lambda at: arm.frame(link, at), q)


def _truth(first: Callable[[Symbols], FloatArray], second: Callable[[Symbols], FloatArray]) -> Truth:
    """Return a truth of a Jacobian, whole as J and element by element."""
    return Truth(
        lambda s: whole_and_elements("J", first(s)),
        lambda s: whole_and_elements("J", second(s)),
        _JACOBIAN_WAYS,
    )


# Jacobians of the tip and of the link ends. Link i ends where joint i+1 sits, the last one at the tip.

_ENDS = ("q2", "q3", "tip")


def _tip(arm: Arm) -> Truth:
    return _truth(lambda s: model_jacobian(arm, arm.q(s)), lambda s: jacobian_by_chain(arm, arm.q(s)))


def _linear(arm: Arm, link: int) -> Truth:
    return _truth(
        lambda s: model_jacobian(arm, arm.q(s), _ENDS[link - 1])[:, :3],
        lambda s: jacobian_by_chain(arm, arm.q(s), link)[:, :3],
    )


def _angular(arm: Arm, link: int) -> Truth:
    return _truth(
        lambda s: model_jacobian(arm, arm.q(s), f"link{link}")[:, 3:],
        lambda s: jacobian_by_chain(arm, arm.q(s), link)[:, 3:],
    )


macro_jacobian, mini_jacobian = _tip(MACRO), _tip(MINI)
macro_linear_1, macro_linear_2, macro_linear_3 = (_linear(MACRO, link) for link in (1, 2, 3))
mini_linear_1, mini_linear_2, mini_linear_3 = (_linear(MINI, link) for link in (1, 2, 3))
macro_angular_1, macro_angular_2, macro_angular_3 = (_angular(MACRO, link) for link in (1, 2, 3))
mini_angular_1, mini_angular_2, mini_angular_3 = (_angular(MINI, link) for link in (1, 2, 3))


# Axes and position vectors.


def _axis(arm: Arm, frame: int) -> Truth:
    return Truth(
        lambda s: coordinates("Z", model_jacobian(arm, arm.q(s))[:, 3:, frame]),
        lambda s: coordinates("Z", arm.frame(frame, arm.q(s))[:, :3, 2]),
        ("angular Jacobian by Pinocchio", "z axis of the chain's frame"),
    )


def _end(arm: Arm, link: int) -> Truth:
    return Truth(
        lambda s: coordinates("P", np.array([_model_of(arm, _ENDS[link - 1]).tip_position(q) for q in arm.q(s)])),
        lambda s: coordinates("P", arm.frame(link, arm.q(s))[:, :3, 3]),
        ("Pinocchio", WAYS[1]),
    )


macro_axis_0, macro_axis_1, macro_axis_2 = (_axis(MACRO, frame) for frame in range(3))
mini_axis_0, mini_axis_1, mini_axis_2 = (_axis(MINI, frame) for frame in range(3))
macro_end_1, macro_end_2, macro_end_3 = (_end(MACRO, link) for link in (1, 2, 3))
mini_end_1, mini_end_2, mini_end_3 = (_end(MINI, link) for link in (1, 2, 3))


def axes_of_frames(s: Symbols) -> Elements:
    """Return 0R_i Z for frames 1 and 2, Z_i as section 3.1 defines it."""
    q = MACRO.q(s)
    return {f"Z_{i}": model_frame(MACRO, i, q)[:, :3, :3] @ np.array([0.0, 0.0, 1.0]) for i in (1, 2)}


joint_axes = Truth(
    lambda s: {f"Z_{i}": model_jacobian(MACRO, MACRO.q(s))[:, 3:, i] for i in (1, 2)},
    lambda s: {f"Z_{i}": jacobian_by_chain(MACRO, MACRO.q(s))[:, 3:, i] for i in (1, 2)},
    _JACOBIAN_WAYS,
)
"""Axes of joints 2 and 3: frame i lies on the axis of joint i+1."""


def tip_column(s: Symbols) -> Elements:
    """Return the last column of T_03, section 3.3.1."""
    return coordinates("P", tip_pose(MACRO, MACRO.q(s))[:, :3, 3])


# Velocity.


def _times_velocity(arm: Arm, rows: slice) -> Way:
    def velocity(s: Symbols) -> Elements:
        J = model_jacobian(arm, arm.q(s))[:, rows]
        return {"v": along(J, arm.dq(s))}

    return velocity


def _velocity(arm: Arm, rows: slice) -> Truth:
    def by_motion(s: Symbols) -> Elements:
        q, dq = arm.q(s), arm.dq(s)

        def pose(time: FloatArray) -> FloatArray:
            return tip_pose(arm, q + time * dq)

        start = np.zeros((len(q), 1))
        change = derivative(pose, start, 0)
        spin = change[:, :3, :3] @ pose(start)[:, :3, :3].transpose(0, 2, 1)
        twist = np.column_stack([change[:, :3, 3], spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]])
        return {"v": twist[:, rows]}

    def by_chain(s: Symbols) -> Elements:
        return {"v": along(jacobian_by_chain(arm, arm.q(s))[:, rows], arm.dq(s))}

    return Truth(by_motion, by_chain, ("Pinocchio's pose a moment before and after", "differences of the chain's pose"))


macro_twist = _velocity(MACRO, slice(0, 6))
macro_velocity, mini_velocity = _velocity(MACRO, slice(0, 3)), _velocity(MINI, slice(0, 3))
macro_times_velocity = _times_velocity(MACRO, slice(0, 6))
macro_linear_times_velocity = _times_velocity(MACRO, slice(0, 3))
mini_linear_times_velocity = _times_velocity(MINI, slice(0, 3))


# The general formulas, on the Macro.


def transposed(s: Symbols) -> Elements:
    """Return J_ij = dG_j / dq_i as printed before (3.4)."""
    return {"J": macro_linear_3.second(s)["J"].transpose(0, 2, 1)}


def position_derivatives(s: Symbols) -> Elements:
    """Return dG_i / dq_j."""
    return {"J": macro_linear_3.second(s)["J"]}


def with_following_axes(s: Symbols) -> Elements:
    """Return (3.4) and (3.5): the angular part of column i is Z_i, the z axis of frame i."""
    q = MACRO.q(s)
    axes = np.stack([model_frame(MACRO, i, q)[:, :3, 2] for i in (1, 2, 3)], axis=2)
    return {"J": np.concatenate([position_derivatives(s)["J"], axes], axis=1)}


def with_joint_axes(s: Symbols) -> Elements:
    """Return the same with Z_{i-1}."""
    q = MACRO.q(s)
    axes = np.stack([model_frame(MACRO, i, q)[:, :3, 2] for i in (0, 1, 2)], axis=2)
    return {"J": np.concatenate([position_derivatives(s)["J"], axes], axis=1)}


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


def mini_symbolic_columns(s: Symbols) -> Elements:
    """Return (4.2)."""
    return {"J": MINI.end_jacobian(3, MINI.q(s))}


def _link_columns(rows: slice, link: int) -> Way:
    return lambda s: {"J": MACRO.end_jacobian(link, MACRO.q(s))[:, rows]}


linear_columns_1, linear_columns_2, linear_columns_3 = (_link_columns(slice(0, 3), link) for link in (1, 2, 3))
angular_columns_3 = _link_columns(slice(3, 6), 3)
"""(3.14) and (3.15): Z_{i-1} x p and Z_{i-1}, and zeros behind the link."""


def end_by_differences(s: Symbols) -> Elements:
    """Return (3.13): derivatives of the position of the second link's end."""
    return {"J": jacobian_by_chain(MACRO, MACRO.q(s), 2)[:, :3]}
