r"""Contradictions between the signals of a log: sign, order and unit of joints, by the arm's own equations.

A log is compared with itself, not with a run: torques with those of the rigid body at the recorded motion, the tip with
the forward kinematics, and positions with commanded ones. With the recorded torque tau_j of joint j and the
torque of the model \hat\tau_j, the lack of fit is

.. math:: r_j = \min_{a, b, c \ge 0} \frac{|\tau_j - \hat\tau_j - a\,\ddot q_j - b\,\dot q_j -
    c\,\mathrm{sgn}\,\dot q_j|}{|\tau_j|}

The three columns stand for the inertia of the rotor and friction. As these cannot be below zero, the sign of a joint
without gravity is seen, too. The model's torque has a further factor where a current times a constant is recorded, as
the constant may be wrong. Another meaning of a column is asked for if it lowers the sum of the logarithms of all r
clearly: errors of masses and friction do not. A heavy payload may; it is fitted to all torques together, and a note
names it instead of a question if it explains them about as well.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.optimize import nnls

from runner.base.arrays import FloatArray
from runner.recordings.columns_map import Signal
from runner.recordings.equations import find_jumps
from runner.recordings.other_meanings import (
    MOVES,
    NO_GRAVITY,
    OF_NOISE,
    EvenMotion,
    OtherMeaning,
    fit_payload,
    other_meanings,
    scaled,
)
from runner.recordings.recording import Recording
from runner.recordings.smoothing import cutoff, derivative, evenly, low_pass
from runner.robots.model import RobotModel

_MOST = 20_000  # rows that are smoothed
_ROWS = 300  # at which the equations are evaluated
_CLEARLY = 0.5  # of the sum of logarithms: another meaning explains 40 % more
_LEAST = {"torque": 0.15, "tip": 0.03, "reference": 0.1}  # r above which a meaning is doubted at all
_NOISE = {"torque": 0.05, "tip": 0.005, "reference": 0.05}  # of a signal's size, below which r tells nothing
_SLOWEST_ROWS = 0.5  # s
_TOO_FAST = 3.0  # times the limit of a joint's speed, in half of all rows
_ZERO = 1e-9  # N m: a torque that is smaller in all rows counts as zero
_OFFSET = 1e-3  # m, of the tip, that is reported
_NO_TIP = 0.25  # r of a tip: a delay of 0.1 s leaves less
_WORSE = 0.1  # of a torque
_CLIPPED, _PILE = 0.05, 3.0  # share of rows at a limit, and how many more than near it, of a clipped torque
_NEAR = 0.1  # of the range of a torque
_AT_REST = 0.01  # of the largest speed of a joint
_FITS = 0.5  # r below which degrees explain a signal
_DOUBTED, _HALVED = 0.1, 0.5  # r from which on the unit of a torque is doubted, and how much less another one leaves
_OTHER_SCALE = 3.0  # times the model's torque, from which on a unit is doubted
_SHOWN_ARM = 0.01  # m
_ABOUT = 0.1  # of the sum of logarithms, by which a payload may explain less than another meaning


@dataclass(frozen=True)
class LogVerdict:
    """What the signals of a log say of each other.

    Attributes:
        questions: Contradictions, each with its evidence and the line of the column map that settles it.
        notes: Observations that need no answer.
        confirmed: Evidence for each joint: signals that would contradict another sign of its position.
    """

    questions: tuple[str, ...]
    notes: tuple[str, ...]
    confirmed: dict[str, tuple[str, ...]]


def check_consistency(model: RobotModel, recording: Recording) -> LogVerdict:
    """Return the contradictions between the signals of a log.

    Args:
        model: The arm.
        recording: The log.
    """
    joints = model.joint_names
    q = recording.positions(joints)
    questions = [*_empty_torques(recording), *_slow_rows(recording), *find_jumps(model, recording)]
    if questions or q is None:
        return LogVerdict(tuple(questions), (), {})
    motion = _motion(recording, joints, q)
    if not motion.moves.any():
        text = f"no joint moves by {MOVES:g} rad and by {OF_NOISE:g} times the noise of its encoder"
        return LogVerdict((f"the arm stands still: {text}. Use a log of a motion.",), (), {})
    found, notes = _with_payload(model, recording, motion, _examine(model, recording, motion))
    judge, before = found.judge, found.before
    if found.chosen and (clipped := list(_clipped(model, recording, q, before))):
        return LogVerdict(tuple(clipped), (), {})
    questions += [_question(meaning, joints, before, judge.lacks(found.changed)) for meaning in found.chosen]
    notes += [] if questions else list(_tip_offset(model, judge, motion))
    questions += [] if questions else list(_unexplained(before))
    questions += [] if questions else list(_too_fast(model, recording, q))
    questions += [] if questions else list(found.scales.values())
    if questions:
        return LogVerdict(tuple(questions), (), {})
    return LogVerdict((), tuple(notes), dict(_confirmed(judge, motion, before, joints)))


@dataclass(frozen=True)
class _Examined:
    """What an arm says of a motion: lacks before, other meanings, the motion that they make, and doubts of units.

    `left` is the sum of logarithms that the proposed changes leave.
    """

    judge: "_Judge"
    before: dict[tuple[str, int], float]
    chosen: list[OtherMeaning]
    changed: EvenMotion
    scales: dict[int, str]
    left: float

    @property
    def doubts(self) -> int:
        return len(self.chosen) or len(self.scales)


def _examine(model: RobotModel, recording: Recording, motion: EvenMotion) -> _Examined:
    judge = _Judge(model, recording)
    before = judge.lacks(motion)
    chosen, changed = _best(judge, motion, before, list(other_meanings(model, recording, motion)))
    left = _total(judge.lacks(changed))
    found = dict(_scales(judge, motion, recording, model.joint_names))
    then = _total({**before, **{("torque", joint): lack for joint, (lack, _) in found.items()}})
    if found and then < left:
        chosen, changed, left = [], motion, then
    scales = {} if chosen else {joint: question for joint, (_, question) in found.items()}
    return _Examined(judge, before, chosen, changed, scales, left)


def _with_payload(
    model: RobotModel, recording: Recording, motion: EvenMotion, bare: _Examined
) -> tuple[_Examined, list[str]]:
    """Return the same with the payload, and a note of it, if that leaves fewer doubts and explains about as much."""
    fitted = fit_payload(model, motion, lambda arm: _Judge(arm, recording).rigid(motion)) if bare.doubts else None
    if fitted is None:
        return bare, []
    mass, centre = fitted
    loaded = _examine(model.with_payload(mass, centre), recording, motion)
    if loaded.doubts >= bare.doubts or loaded.left > bare.left + _ABOUT:
        return bare, []
    place = " ".join(f"{1e3 * value:.0f}" for value in centre)
    where = "at the tip" if np.linalg.norm(centre) < _SHOWN_ARM else f"at ({place}) mm in the frame {model.tip_name}"
    return loaded, [
        f"a payload of about {mass:.2g} kg {where} explains the torques; say payload: in the map, or robot.payload.mass"
    ]


def _empty_torques(recording: Recording) -> Iterator[str]:
    for signal, values in recording.signals.items():
        if signal.kind == "torque" and np.abs(values).max() < _ZERO:
            yield (
                f"columns.{recording.columns[signal]}: the torque of {signal.of} is 0 in all rows (largest "
                f"{np.abs(values).max():.3g}): the drive reports none. Leave out the column."
            )


def _slow_rows(recording: Recording) -> Iterator[str]:
    if recording.period > _SLOWEST_ROWS:
        yield (
            f"time: rows are {recording.period:.3g} s apart: is it in ms, or a number of rows? Say unit: ms, or rate "
            "instead of time."
        )


def _clipped(
    model: RobotModel, recording: Recording, q: FloatArray, lacks: dict[tuple[str, int], float]
) -> Iterator[str]:
    """Yield a question for each torque that the motion does not explain, and that stays at a limit while it moves."""
    for (kind, place), lack in lacks.items():
        if kind != "torque" or lack < _LEAST["torque"] or np.ptp(q[:, place]) <= MOVES:
            continue
        signal = Signal("torque", model.joint_names[place])
        speed = np.abs(np.gradient(q[:, place], recording.t))
        values = recording.signals[signal][speed > _AT_REST * speed.max()]
        for limit in (values.max(), values.min()):
            at_limit = np.abs(values - limit) <= 1e-9 * abs(limit)
            near = (np.abs(values - limit) < _NEAR * np.ptp(values)) & ~at_limit
            if at_limit.mean() > _CLIPPED and at_limit.sum() > _PILE * near.sum():
                yield (
                    f"columns.{recording.columns[signal]}: the torque of {signal.of} is {limit:.4g} "
                    f"{'N' if model.joint_units[place] == 'm' else 'N m'} in {at_limit.mean():.0%} of the rows in "
                    "which it moves, and the motion needs more: it is clipped. Leave out the column, or use a log "
                    "whose torques stay below."
                )
                break


def _unexplained(lacks: dict[tuple[str, int], float]) -> Iterator[str]:
    """Yield a question if the tip does not follow from the positions, and no other meaning of one column helps."""
    if (lack := lacks.get(("tip", 0), 0.0)) > _NO_TIP:
        yield (
            f"columns of the tip: {lack:.0%} of its motion does not follow from the positions, in any order of two. "
            "Say the right joints, the frame of the tip, or leave out its columns."
        )


def _too_fast(model: RobotModel, recording: Recording, q: FloatArray) -> Iterator[str]:
    speeds = np.median(np.abs(np.diff(q, axis=0)) / np.diff(recording.t)[:, None], axis=0)
    fast = np.flatnonzero(speeds > _TOO_FAST * model.velocity_limits)
    if len(fast):
        joint = model.joint_names[fast[0]]
        yield (
            f"columns.{recording.columns[Signal('position', joint)]}: {joint} would move at {speeds[fast[0]]:.3g} "
            f"{model.joint_units[fast[0]]}/s, and its limit is {model.velocity_limits[fast[0]]:.3g}"
            f"{f' ({len(fast)} joints like this)' if len(fast) > 1 else ''}. Say the unit of the time or the column."
        )


def _motion(recording: Recording, joints: Sequence[str], q: FloatArray) -> EvenMotion:
    every = max(1, len(recording.t) // _MOST)
    period, t = every * recording.period, recording.t[::every]
    times = np.minimum(period * np.arange(int(t[-1] / period + 1e-6) + 1), t[-1])
    even = evenly(t, q[::every], times)
    smooth = low_pass(even, period, cutoff(period))
    dq = derivative(smooth, period)
    edge = min(len(times) // 10, round(0.5 / period))
    rows = np.unique(np.linspace(edge, len(times) - 1 - edge, min(_ROWS, len(times) - 2 * edge)).astype(int))

    def others(kind: str, names: Sequence[str]) -> FloatArray:
        columns = np.full((len(rows), len(names)), np.nan)
        for place, name in enumerate(names):
            values = recording.signals.get(Signal(kind, name))  # type: ignore[arg-type]
            if values is not None:
                shift = recording.torque_shift if kind == "torque" else 0.0
                even = np.interp(times, recording.t + shift, values)
                columns[:, place] = low_pass(even, period, cutoff(period))[rows]
        return columns

    noise = np.sqrt(np.mean((even - smooth) ** 2, axis=0))
    moves = np.ptp(smooth, axis=0) > np.maximum(MOVES, OF_NOISE * noise)
    return EvenMotion(
        moves, smooth[rows], dq[rows], derivative(dq, period)[rows],
        others("torque", joints), others("tip", ("x", "y", "z")), others("reference", joints),
    )  # fmt: skip


def measured_arm(model: RobotModel, recording: Recording) -> RobotModel:
    """Return the arm whose torques the sensors of a log measure: without gravity, or without rotors; see Column."""
    if recording.holds == "without_gravity":
        model = model.with_change(lambda pin_model: setattr(pin_model, "gravity", pin.Motion.Zero()))
    return model if recording.side == "motor" else model.with_armature(np.zeros(model.nq))


class _Judge:
    """Lack of fit of a motion, by the kind of evidence and joint."""

    def __init__(self, model: RobotModel, recording: Recording) -> None:
        self._model, self._data = measured_arm(model, recording).separate()
        self._tip = model.tip_frame
        self.currents = [model.joint_names.index(signal.of) for signal in recording.currents]

    def rigid(self, motion: EvenMotion) -> FloatArray:
        """Return the torques of the model, shape (N, nq)."""
        rows = zip(motion.q, motion.dq, motion.ddq, strict=True)
        return np.array([pin.rnea(self._model, self._data, *row) for row in rows])

    def lacks(self, motion: EvenMotion) -> dict[tuple[str, int], float]:
        """Return r of each signal that is recorded, by its kind and joint."""
        found: dict[tuple[str, int], float] = {}
        recorded = np.flatnonzero(~np.isnan(motion.torque[0]))
        if len(recorded):
            rigid = self.rigid(motion)
            for joint in recorded.tolist():
                y, model = motion.torque[:, joint], rigid[:, joint]
                found["torque", joint] = (
                    _left_over(motion, joint, y, model)  # its constant may be wrong
                    if joint in self.currents
                    else self.unexplained(motion, joint, model)
                )
        axes = ~np.isnan(motion.tip[0])
        if axes.any():
            rest, swing = self.tip_rest(motion)[0], motion.tip[:, axes] - motion.tip[:, axes].mean(axis=0)
            found["tip", 0] = float(np.linalg.norm(rest) / max(float(np.linalg.norm(swing)), _ZERO))
        for joint in np.flatnonzero(~np.isnan(motion.reference[0])).tolist():
            command, own = (values[:, joint] - values[:, joint].mean() for values in (motion.reference, motion.q))
            if np.ptp(command) > MOVES:
                found["reference", joint] = float(np.linalg.norm(own - command) / np.linalg.norm(command))
        return found

    def unexplained(self, motion: EvenMotion, joint: int, model: FloatArray) -> float:
        """Return the share of a torque that the model's, of shape (N,), and friction do not explain, with any rotor."""
        without_rotor = model - self._model.armature[joint] * motion.ddq[:, joint]
        return _left_over(motion, joint, motion.torque[:, joint] - without_rotor)

    def tip_rest(self, motion: EvenMotion) -> tuple[FloatArray, FloatArray]:
        """Return the residual of the tip, shape (3 N,), and its offsets in the frame of the tip and in the base."""
        axes = np.flatnonzero(~np.isnan(motion.tip[0]))
        pose, blocks, reached = self._data.oMf[self._tip], np.empty((len(motion.q), 3, 6)), np.empty(motion.tip.shape)
        blocks[:, :, 3:] = np.eye(3)
        for row, q in enumerate(motion.q):
            pin.forwardKinematics(self._model, self._data, q)
            pin.updateFramePlacement(self._model, self._data, self._tip)
            blocks[row, :, :3], reached[row] = pose.rotation, pose.translation
        A, b = blocks[:, axes].reshape(-1, 6), (motion.tip - reached)[:, axes].ravel()
        offsets = np.asarray(np.linalg.lstsq(A, b, rcond=1e-6)[0], dtype=np.float64)
        return b - A @ offsets, offsets


def _total(lacks: dict[tuple[str, int], float]) -> float:
    return float(sum(np.log(min(lack, 10.0) + _NOISE[kind]) for (kind, _), lack in lacks.items()))


def _best(
    judge: _Judge, motion: EvenMotion, before: dict[tuple[str, int], float], meanings: Sequence[OtherMeaning]
) -> tuple[list[OtherMeaning], EvenMotion]:
    """Return the meanings that together fit clearly better, and the motion that they make."""
    chosen: list[OtherMeaning] = []
    total = _total(before)
    while any(lack > _LEAST[kind] for (kind, _), lack in before.items()) and len(chosen) < motion.q.shape[1]:
        tried = [
            (_total(lacks), number)
            for number, meaning in enumerate(meanings)
            if not _spoils(meaning, before, lacks := judge.lacks(meaning.change(motion)))
            and _fits(meaning, before, lacks)
        ]
        least, number = min(tried, default=(total, 0))
        if least > total - _CLEARLY:
            break
        chosen.append(meanings[number])
        motion, total = meanings[number].change(motion), least
        meanings = [meaning for meaning in meanings if meaning is not chosen[-1]]
        before = judge.lacks(motion)
    return chosen, motion


def _spoils(meaning: OtherMeaning, before: dict[tuple[str, int], float], after: dict[tuple[str, int], float]) -> bool:
    """Return whether a meaning of all torques makes one of them fit worse: that of another one is wrong then."""
    return meaning.line == NO_GRAVITY and any(after[key] > lack + _WORSE for key, lack in before.items())


def _fits(meaning: OtherMeaning, before: dict[tuple[str, int], float], after: dict[tuple[str, int], float]) -> bool:
    """Return whether a meaning explains the signal that decides; degrees also shrink the noise of accelerations."""
    return after[_deciding(before, after)] < (_FITS if meaning.line == "unit: deg" else 1.0)


def _deciding(before: dict[tuple[str, int], float], after: dict[tuple[str, int], float]) -> tuple[str, int]:
    """Return the signal, by kind and joint, whose lack another meaning lowers most."""

    def gained(key: tuple[str, int]) -> float:
        noise = _NOISE[key[0]]
        return float(np.log(before[key] + noise) - np.log(after[key] + noise))

    return max(before, key=gained)


def _question(
    meaning: OtherMeaning,
    joints: Sequence[str],
    before: dict[tuple[str, int], float],
    after: dict[tuple[str, int], float],
) -> str:
    """Return a question with the two numbers that decide: what is unexplained before and after."""
    kind, joint = _deciding(before, after)
    of = {"tip": "the tip", "torque": "the torque of ", "reference": "the commanded position of "}[kind]
    what = of if kind == "tip" else f"{of}{joints[joint]}"
    return (
        f"{meaning.words}; {before[kind, joint]:.0%} of {what} is unexplained now, {after[kind, joint]:.0%} then. "
        f"Say {meaning.line}."
    )


def _tip_offset(model: RobotModel, judge: _Judge, motion: EvenMotion) -> Iterator[str]:
    if np.isnan(motion.tip[0]).all():
        return
    rest, offsets = judge.tip_rest(motion)
    axes = ~np.isnan(motion.tip[0])
    if np.linalg.norm(offsets) > _OFFSET and np.sqrt(np.mean(rest**2)) < max(_OFFSET, 0.1 * np.linalg.norm(offsets)):
        tool, base = (" ".join(f"{1e3 * value:.1f}" for value in part) for part in (offsets[:3], offsets[3:]))
        apart = np.array([(tip - model.tip_position(q))[axes] for q, tip in zip(motion.q, motion.tip, strict=True)])
        yield (
            f"geometry differs by {1e3 * np.sqrt(np.mean(np.sum(apart**2, axis=1))):.3g} mm: the tip is a rigid offset "
            f"({tool}) mm in the frame {model.tip_name} and ({base}) mm in the base away. Choose the robot's tip, or "
            "the zero of the columns"
        )


def _scales(
    judge: _Judge, motion: EvenMotion, recording: Recording, joints: Sequence[str]
) -> Iterator[tuple[int, tuple[float, str]]]:
    """Yield the joint of each torque that fits the model in another unit only, what that leaves, and a question."""
    rigid = judge.rigid(motion)
    for joint in np.flatnonzero(~np.isnan(motion.torque[0])).tolist():
        y, model = motion.torque[:, joint], rigid[:, joint]
        scale = float(y @ model) / max(float(model @ model), _ZERO)
        friction = [motion.dq[:, joint], np.sign(motion.dq[:, joint])]
        inverse = float(np.linalg.lstsq(np.column_stack([y, *friction]), model)[0][0])  # without noise in the model
        lack, then = judge.unexplained(motion, joint, model), _left_over(motion, joint, y, model)
        low = scale < 1.0 / _OTHER_SCALE and inverse > _OTHER_SCALE
        high = scale > _OTHER_SCALE and inverse < 1.0 / _OTHER_SCALE
        if scale <= 0.0 or not (low or high) or lack < _DOUBTED or then >= _HALVED * lack:
            continue
        name = recording.columns[Signal("torque", joints[joint])]
        settles = 'its unit; of a per cent say unit: "%" and scale'
        if joint in judge.currents:
            settles = f"its constant: {recording.units[name].factor / scale:.3g} would fit"
        yield (
            joint,
            (
                then,
                f"columns.{name}: the torque of {joints[joint]} is {scale:.3g} times the model's; {lack:.0%} is "
                f"unexplained now, {then:.0%} then. Say {settles}.",
            ),
        )


def _left_over(motion: EvenMotion, joint: int, rest: FloatArray, *columns: FloatArray) -> float:
    """Return the share of a recorded torque that columns, friction and a rotor do not explain of the rest of it."""
    speed, size = motion.dq[:, joint], max(float(np.linalg.norm(motion.torque[:, joint])), _ZERO)
    return float(nnls(np.column_stack([*columns, motion.ddq[:, joint], speed, np.sign(speed)]), rest)[1]) / size


def _confirmed(
    judge: _Judge, motion: EvenMotion, before: dict[tuple[str, int], float], joints: Sequence[str]
) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield what would contradict another sign of each joint."""
    for place, joint in enumerate(joints):
        turned = judge.lacks(scaled(place, -1.0)(motion)) if before else {}
        kinds = dict.fromkeys(kind for (kind, at), lack in turned.items() if lack > before[kind, at] + _LEAST[kind])
        yield joint, tuple(kinds)
