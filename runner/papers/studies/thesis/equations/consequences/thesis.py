"""Motions of the thesis arms under the printed and the correct formulas. Lengths in m."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.audit.consequence import Consequence
from runner.papers.audit.derivations import along
from runner.papers.audit.entry import values_at
from runner.papers.studies.thesis.equations.derivations import thesis_measures
from runner.papers.studies.thesis.equations.derivations.thesis_arms import COMBINED, MACRO, MINI, ThesisArm
from runner.papers.studies.thesis.equations.derivations.thesis_jacobians import frame_symbols
from runner.papers.studies.thesis.equations.derivations.thesis_kinematics import tip_pose
from runner.trajectories.motion import quintic_motion

_GOAL = np.array([0.1679, -0.7571, 0.4255])  # of the Macro, section 3.3.1; the Mini's is a tenth of it
_DURATION = 3.0  # s
_STEP = 0.002  # s
_GAIN = 30.0  # 1/s, of the position error: the Macro's natural frequency
_FASTEST = 20.0  # rad/s, at which a joint's speed is cut
_OFFSET = np.array([0.0, 0.1, 0.1])  # tip of the Mini at home, from its base
_LEAN = np.array([0.0, -0.5, 0.7])  # rad, the Macro under the leaning Mini
_FREQUENCY = 30.0  # rad/s, section 3.3.1
_POSTURE = (0.0, -0.4)  # rad, joints 1 and 2 of the Macro held by its gravity term

Jacobian = Callable[[FloatArray], FloatArray]


def _follow(arm: ThesisArm, jacobian: Jacobian) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return times, joint positions and distances from the path of an arm led along the thesis' quintic by joint rates.

    The joints move at J^+ (dx_d + k (x_d - x)), with the given J and the tip's true position, from home.
    """
    model = arm.model
    path = quintic_motion(model.tip_position(np.zeros(3)), _GOAL * arm.a[2], _DURATION)
    times = np.arange(0.0, _DURATION + _STEP / 2, _STEP)
    motion = path.sample(times)
    q, missed = np.zeros((len(times), 3)), np.zeros(len(times))
    for tick in range(len(times)):
        tip = model.tip_position(q[tick])
        missed[tick] = np.linalg.norm(motion[tick, 0] - tip)
        if tick + 1 < len(times):
            wanted = motion[tick, 1] + _GAIN * (motion[tick, 0] - tip)
            speed = np.linalg.pinv(jacobian(q[tick]), rcond=1e-6) @ wanted
            q[tick + 1] = q[tick] + _STEP * np.clip(speed, -_FASTEST, _FASTEST)
    return times, q, missed


def _right(arm: ThesisArm) -> Jacobian:
    return lambda q: arm.model.tip_jacobian(q)[:3]


def lever_arms() -> Consequence:
    """Return the Macro's errors on its path by the columns of (3.6), and by the exchanged indices of J_ij."""

    def printed(q: FloatArray) -> FloatArray:
        names = frame_symbols(MACRO, q[None]) | {f"eps_{i}": np.ones(1) for i in (1, 2, 3)}
        columns = values_at("thesis", "thesis-3.6", names)
        return np.column_stack([columns[f"J_{i}"][0] for i in (1, 2, 3)])

    def exchanged(q: FloatArray) -> FloatArray:
        return _right(MACRO)(q).T

    times, _, right = _follow(MACRO, _right(MACRO))
    by_levers, by_indices = (_follow(MACRO, jacobian)[2] for jacobian in (printed, exchanged))
    curves = {"levers of (3.6)": by_levers, "indices of J_ij": by_indices, "corrected": right}
    return Consequence(times, curves, {"right_mm": 1e3 * right.max()})


def mini_jacobian() -> Consequence:
    """Return the Mini's error on its path by the printed J_v6."""

    def printed(q: FloatArray) -> FloatArray:
        J = _right(MINI)(q)
        J[2, 1] = -0.1 * np.sin(q[1] + q[2]) + np.cos(q[1])
        return J

    times, _, right = _follow(MINI, _right(MINI))
    wrong = _follow(MINI, printed)[2]
    numbers = {"wrong_mm": 1e3 * wrong.max(), "right_mm": 1e3 * right.max()}
    return Consequence(times, {"as printed": wrong, "corrected": right}, numbers)


def chained_tables() -> Consequence:
    """Return the error of the combined arm's tip by the two D-H tables, one behind the other."""
    angle = np.linspace(0.0, 1.0, 101)
    q = angle[:, None] * np.ones(6)
    real = tip_pose(COMBINED, q)[:, :3, 3]
    arms = {"T_0E": tip_pose(MACRO, q[:, :3]), "T_36": tip_pose(MINI, q[:, 3:])}
    said, emended = (
        np.linalg.norm(values_at("thesis", "thesis-frame-3", arms, corrected=right)["T"][:, :3, 3] - real, axis=1)
        for right in (False, True)
    )
    return Consequence(angle, {"as printed": said, "corrected": emended})


def mini_reference() -> Consequence:
    """Return the tip's error if the Mini follows the difference in frame 0, with the Macro on its path."""
    times, q, _ = _follow(MACRO, _right(MACRO))
    turn = thesis_measures.base_of_mini(q)
    wanted = np.tile(_OFFSET, (len(times), 1))
    given = {"as printed": wanted, "corrected": along(turn.transpose(0, 2, 1), wanted)}
    missed = {name: np.linalg.norm(along(turn, r) - wanted, axis=1) for name, r in given.items()}
    return Consequence(times, missed)


def leaning_mini() -> Consequence:
    """Return the Mini's errors under its weight's torques: by the printed G, and with gravity turned into frame 3."""
    g = along(thesis_measures.base_of_mini(_LEAN[None]).transpose(0, 2, 1), np.array([[0.0, 0.0, -9.81]]))
    times = np.arange(0.0, 0.3 + _STEP / 2, _STEP)
    whole, mini = COMBINED.model, MINI.model

    def fallen(weight: Callable[[FloatArray], FloatArray]) -> FloatArray:
        q, dq = np.array([0.0, 0.3, 0.4]), np.zeros(3)
        start, distances = mini.tip_position(q), []
        for _ in times:
            distances.append(float(np.linalg.norm(mini.tip_position(q) - start)))
            state = np.concatenate([_LEAN, q])
            bias = whole.coriolis_torque(state, np.concatenate([np.zeros(3), dq])) + whole.gravity_torque(state)
            torque = weight(q[None])[0] - bias[3:]  # the Macro is held, so its joints do not move
            dq = dq + _STEP * np.linalg.solve(whole.mass_matrix(state)[3:, 3:], torque)
            q = q + _STEP * dq
        return np.array(distances)

    printed = fallen(MINI.weight)
    right = fallen(lambda q: MINI.weight(q, g))
    return Consequence(times, {"as printed": printed, "corrected": right}, {"printed_mm": 1e3 * printed.max()})


def gravity() -> Consequence:
    """Return the sag of the Macro with s2 instead of s23."""
    degrees = np.linspace(-75, 75, 151)
    q = np.column_stack([np.full(len(degrees), angle) for angle in _POSTURE] + [np.radians(degrees)])
    c2, s2, s23 = np.cos(q[:, 1]), np.sin(q[:, 1]), np.sin(q[:, 1] + q[:, 2])
    printed, right = (np.column_stack([0 * c2, 19.62 * c2 - 9.81 * s, -9.81 * s]) for s in (s2, s23))
    sag = _sag(q, printed)
    numbers = {"frequency": _FREQUENCY, "sag_cm": 100 * sag.max()}
    return Consequence(degrees, {"as printed": sag, "corrected": _sag(q, right)}, numbers)


def _sag(q: FloatArray, compensated: FloatArray) -> FloatArray:
    """Return the tip's distance from its goal at rest: Lambda omega_n^2 error = J^-T (G - what is compensated)."""
    model = MACRO.model
    distances = []
    for row, torque in zip(q, compensated, strict=True):
        missing = np.linalg.solve(model.mass_matrix(row), model.gravity_torque(row) - torque)
        distances.append(np.linalg.norm(model.tip_jacobian(row)[:3] @ missing) / _FREQUENCY**2)
    return np.array(distances)
