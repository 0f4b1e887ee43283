"""Verdict on a model by a recording: how well it predicts, what explains the rest, and what the log does not tell."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pinocchio as pin
from scipy.optimize import lsq_linear

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.recordings.columns_map import Signal
from runner.recordings.compare import RecordingComparison, Residual
from runner.recordings.consistency import measured_arm
from runner.recordings.motions import cut_at_rests
from runner.recordings.smoothing import acceleration_noise, cutoff, derivative, low_pass
from runner.robots.model import RobotModel

_MOST_ROWS = 2_000
_EDGE = 0.05  # of the rows at each end, where the low-pass knows only one side
_POSES = 20  # at which the mass matrix is taken
_HIDES = 0.5  # of a torque's differences, from which on noise hides them
_TINY = 0.01  # of the torques' rms: the differences of which no cause is named
_EXPLAINS = 0.1  # of the squares of the torques' differences, from which on a cause is named


def verdict_lines(found: RecordingComparison) -> Iterator[str]:
    """Yield sentences: the accuracy of positions and torques, what explains the torques' differences, open questions.

    Args:
        found: The recording and the run.
    """
    first, last = found.span
    positions = "" if found.follows_measured else _positions(found.residuals)
    hidden = _hidden(found)
    said = [text for text in (positions, _torques(found.residuals, hidden)) if text]
    count = len(cut_at_rests(found))
    many = f", on {count} motions," if count > 1 else ""
    yield f"Over {quantity(last - first, 's')}{many} the model predicts {' and '.join(said)}."
    sizes = torque_shares(found.residuals)
    shares = {} if sizes is None or sizes[0] < _TINY else explained(found)
    causes = [f"{cause} {per_cent(share)}" for cause, share in shares.items() if share >= _EXPLAINS]
    if causes:
        yield f"Share of the torques' squared differences that a single cause explains: {', '.join(causes)}."
    elif shares:
        yield f"None of {', '.join(shares)} explains a tenth of the torques' differences (squares)."
    untold = list(_untold(found, hidden))
    if untold:
        yield f"The log does not tell: {'; '.join(untold)}."


def _positions(residuals: Sequence[Residual]) -> str:
    moving = [one for one in residuals if one.signal.kind == "position"] or [
        one for one in residuals if one.signal.kind == "tip"
    ]
    if not moving:
        return ""
    reached = {one.signal.of: float(np.quantile(np.abs(one.values), 0.95)) for one in moving}
    worst = max(moving, key=lambda one: reached[one.signal.of])
    of = "positions" if worst.signal.kind == "position" else "the tip's coordinates"
    return f"{of} within {quantity(reached[worst.signal.of], worst.unit)} for 95 % of the time ({worst.signal.of})"


def torque_shares(residuals: Sequence[Residual]) -> tuple[float, dict[str, float]] | None:
    """Return the rms of the torques' differences over that of the torques, of all joints and of each; None without."""
    pairs = {
        one.signal.of: (one.rms**2, float(np.mean(one.recorded**2)))
        for one in residuals
        if one.signal.kind == "torque" and np.any(one.recorded)
    }
    if not pairs:
        return None
    whole = np.sqrt(sum(off for off, _ in pairs.values()) / sum(size for _, size in pairs.values()))
    return float(whole), {joint: float(np.sqrt(off / size)) for joint, (off, size) in pairs.items()}


def _torques(residuals: Sequence[Residual], hidden: Sequence[str]) -> str:
    shares = torque_shares(residuals)
    if shares is None:
        return ""
    whole, by_joint = shares
    told = [joint for joint in by_joint if joint not in hidden]
    worst = max(told, key=by_joint.__getitem__, default="")
    of_worst = f" ({worst}: {per_cent(by_joint[worst])})" if worst and len(by_joint) > 1 else ""
    return f"torques to {per_cent(whole)} of their rms{of_worst}"


def noise_torques(found: RecordingComparison) -> Mapping[str, float]:
    r"""Return the rms of the torques that noise of the measured positions makes, by joint, in N m or N.

    They enter where a model follows measured positions. Of accelerations with the noise s_k behind the low-pass it is

    .. math:: s_{\tau_j}^2 = \sum_k M_{jk}^2 s_k^2
    """
    joints = found.model.joint_names
    q, period = found.recording.positions(joints), found.recording.period
    if q is None:
        return {}
    frequency = cutoff(period)
    squares = np.mean((q - low_pass(q, period, frequency)) ** 2, axis=0) / (1.0 - 2.0 * frequency * period)
    accelerations = acceleration_noise(np.sqrt(squares), period, frequency) ** 2
    couplings = np.mean([found.model.mass_matrix(row) ** 2 for row in q[:: len(q) // _POSES + 1]], axis=0)
    return dict(zip(joints, np.sqrt(couplings @ accelerations).tolist(), strict=True))


def _hidden(found: RecordingComparison) -> list[str]:
    """Return the joints whose differences of torques may be those of noise in the positions that the run follows."""
    noise = noise_torques(found) if found.follows_measured else {}
    torques = [one for one in found.residuals if one.signal.kind == "torque"]
    return [one.signal.of for one in torques if noise.get(one.signal.of, 0.0) > _HIDES * one.rms]


def per_cent(share: float) -> str:
    """Return a share in per cent, with one decimal below a tenth."""
    return f"{100.0 * share:.{0 if share > 0.0995 else 1}f} %"


def explained(found: RecordingComparison) -> Mapping[str, float]:
    """Return the share of the torques' squared differences that each single cause explains; empty without torques.

    Differences are those of the recorded torques from the model's at the recorded motion, behind a low-pass, each joint
    divided by the rms of its torque, without joints whose differences noise of the positions hides. The causes are
    viscous and Coulomb friction, another inertia of the rotor, an offset and a factor of the model's torque, of each
    joint, a mass at the tip, and another vector of gravity. Friction and the rotors' inertias are not below zero.
    """
    by_signal, model = {one.signal: one for one in found.residuals}, found.model
    joints = model.joint_names
    wanted = [Signal(kind, joint) for kind in ("position", "torque") for joint in joints]
    if not all(signal in by_signal for signal in wanted):
        return {}
    t = by_signal[wanted[0]].t
    period = float(np.median(np.diff(t)))
    q, tau = (
        low_pass(np.column_stack([by_signal[signal].recorded for signal in part]), period, cutoff(period))
        for part in (wanted[: len(joints)], wanted[len(joints) :])
    )
    dq = derivative(q, period)
    ddq, signs = derivative(dq, period), low_pass(np.sign(dq), period, cutoff(period))
    edge = int(_EDGE * len(t))
    rows = np.arange(edge, len(t) - edge, max(1, len(t) // _MOST_ROWS))
    rigid = measured_arm(model, found.recording)

    def torques(arm: RobotModel) -> FloatArray:
        pin_model, data = arm.pin_model, arm.pin_model.createData()
        return np.array([pin.rnea(pin_model, data, q[row], dq[row], ddq[row]) for row in rows])

    def gravity_along(axis: FloatArray) -> FloatArray:
        arm = rigid.with_change(lambda pin_model: setattr(pin_model, "gravity", pin.Motion(axis, np.zeros(3))))
        return np.array([arm.gravity_torque(q[row]) for row in rows])

    of_model = torques(rigid)
    payload = torques(rigid.with_payload(1.0)) - of_model
    scale = np.sqrt(np.mean(tau[rows] ** 2, axis=0)) + 1e-9
    each, any_sign = np.eye(len(joints)), np.full(len(joints), -np.inf)
    columns = {
        "friction": ([dq[rows][:, :, None] * each, signs[rows][:, :, None] * each], np.zeros(2 * len(joints))),
        "rotor inertia": ([ddq[rows][:, :, None] * each], -rigid.armature),
        "a payload": ([payload[:, :, None]], any_sign[:1]),
        "an offset": ([np.broadcast_to(each, (len(rows), *each.shape))], any_sign),
        "a scale of each torque": ([of_model[:, :, None] * each], any_sign),
    }
    if found.recording.side == "link":
        del columns["rotor inertia"]
    if found.recording.holds != "without_gravity":
        along = [gravity_along(axis)[:, :, None] for axis in np.eye(3)]
        columns["gravity in another direction"] = (along, np.full(3, -np.inf))
    noise = noise_torques(found)
    off = tau[rows] - of_model
    seen = np.array([noise[joint] for joint in joints]) < _HIDES * np.sqrt(np.mean(off**2, axis=0))
    y = (off / scale)[:, seen].ravel()

    def matrix(parts: Sequence[FloatArray]) -> FloatArray:
        return np.concatenate([(part / scale[:, None])[:, seen].reshape(len(y), -1) for part in parts], axis=1)

    return {cause: _share(y, matrix(parts), least) for cause, (parts, least) in columns.items()} if seen.any() else {}


def _share(y: FloatArray, X: FloatArray, least: FloatArray) -> float:
    """Return the share of squares that columns explain with factors of at least `least`, shape (k,)."""
    whole = float(y @ y)
    if whole == 0.0:
        return 0.0
    rest = y - X @ lsq_linear(X, y, (least, np.inf)).x
    return 1.0 - float(rest @ rest) / whole


def _untold(found: RecordingComparison, hidden: Sequence[str]) -> Iterator[str]:
    if found.offset.rivals or found.offset.open_ended:
        yield "when the run begins, so that differences of positions may be those of the time"
    if found.friction is None:
        yield f"friction ({found.no_friction})"
    else:
        lacking = [reason.partition(":")[0] for reason in found.friction.lacking]
        if lacking:
            yield f"friction of {', '.join(lacking)}"
    if found.follows_measured:
        yield "the accuracy of positions, because the run follows the measured ones"
    if hidden:
        yield f"torques of {', '.join(hidden)}, because the noise of the measured positions makes as large ones"
    if not found.lags:
        yield "a lag of the arm, as no commands are known"
    if not found.recording.of_kind("torque"):
        yield "masses, as it holds no torques"
