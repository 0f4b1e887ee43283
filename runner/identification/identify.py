"""Identification of an arm by its logs: examination, choice of friction and cut-off, fit and its checks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from runner.base import progress
from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.identification.checks import SecondMethod, find_flags, find_payload_changes, second_method
from runner.identification.fit import Fit, fit_logs, name_of
from runner.identification.friction_kinds import KINDS, SHAPED, TERMS, FrictionKind, term_unit
from runner.identification.held_out import HeldOut, file_share, joint_weights, predict_held_out
from runner.identification.log_rows import LogRows, read_rows
from runner.identification.parameters import Sum, base_sums
from runner.identification.result import (
    Alternative,
    Identification,
    JointAccuracy,
    LogFacts,
    Parameter,
    Untold,
    place_of,
)
from runner.recordings import digest_of
from runner.recordings.columns_map import AMPERE, ColumnsMap, read_map
from runner.recordings.consistency import check_consistency
from runner.recordings.recording import Recording, read_recording
from runner.recordings.smoothing import cutoff
from runner.robots.model import RobotModel

_SHOWN = 300  # rows of a joint in the result
_WEAK = 0.5  # of the rms of a torque that the interval of a determined parameter may move
_SUMMED = 0.1  # share of a column that another one stands for, from which on it is named
_BETTER = 0.01  # of the held-out error, by which a further term must lower it
_DEVIATIONS = 2.0  # of the gain over the stretches, by which a further term must lower it
_FACTORS = (0.5, 2.0)  # times the usual cut-off, which are tried
_FASTEST = 0.2  # of the rate of rows: the highest cut-off
_NOISY = 10.0  # times the noise of its positions, below which the acceleration of a joint tells little


@dataclass(frozen=True)
class Question:
    """The logs of an arm.

    Attributes:
        robot: Name of the robot.
        model: Model in its file.
        urdf: Its file.
        recordings: The logs.
        said: The column map of each.
        notes: What is unusual about each log.
    """

    robot: str
    model: RobotModel
    urdf: str
    recordings: Sequence[Recording]
    said: Sequence[ColumnsMap]
    notes: Sequence[Sequence[str]]

    @property
    def rotors(self) -> bool:
        """True if the torques turn the rotors."""
        return self.recordings[0].side == "motor"

    @property
    def currents(self) -> list[str]:
        """Joints whose torques are currents times a constant."""
        return [str(column.torque) for column in self.said[0].columns.values() if column.unit == AMPERE]


def read_question(
    robot: str, model: RobotModel, urdf: str, logs: Sequence[Path], maps: Sequence[Path], fill_gaps: float = 0.0
) -> Question:
    """Read the logs of an arm.

    Args:
        robot: Name of the robot.
        model: Its model.
        urdf: Its file.
        logs: The logs.
        maps: A column map for all logs, or one for each.
        fill_gaps: Longest gap of a log that is filled, in s.

    Raises:
        RunnerError: if a log cannot be read, contradicts the robot or itself, or has torques without gravity.
    """
    if len(maps) not in (1, len(logs)):
        raise RunnerError(f"--columns: {len(maps)} maps for {len(logs)} logs. Allowed: one for all, or one for each.")
    if len({path.resolve() for path in logs}) < len(logs):
        raise RunnerError("logs: one is given twice. Allowed: different logs.")
    recordings, found, notes = [], [], []
    for path, columns in zip(logs, maps if len(maps) > 1 else len(logs) * list(maps), strict=True):
        said, factors = read_map(columns, model.joint_names, model.joint_units)
        if said.holds == "without_gravity":
            raise RunnerError(
                f"{columns}: holds: without_gravity leaves no masses to identify. Allowed: torques with gravity; "
                "`runner compare` identifies friction without it."
            )
        recording = read_recording(path, said, factors, fill_gaps)
        verdict = check_consistency(model, recording)
        if verdict.questions:
            raise RunnerError(f"{columns}: {' '.join(verdict.questions)}")
        recordings.append(recording)
        found.append(said)
        notes.append([*recording.notes, *verdict.notes])
    if len({(recording.side, recording.held) for recording in recordings}) > 1:
        raise RunnerError("--columns: the maps differ in side or torque. Allowed: torques of one kind in all logs.")
    return Question(robot, model, urdf, recordings, found, notes)


@dataclass(frozen=True)
class Examination:
    """What logs can determine.

    Attributes:
        question: The logs.
        sums: Base parameters of the arm.
        rows: Rows of the logs at the usual cut-off.
        fit: Fit with viscous and Coulomb friction.
        untold: What the logs do not tell.
        payloads: Changes of the payload, in words.
        notes: What is unusual about each log.
    """

    question: Question
    sums: Sequence[Sum]
    rows: Sequence[LogRows]
    fit: Fit
    untold: Sequence[Untold]
    payloads: Sequence[str]
    notes: Sequence[Sequence[str]]


def examine_logs(question: Question) -> Examination:
    """Return the parameters that logs can determine, from their motion and a fit with viscous and Coulomb friction."""
    sums = base_sums(question.model, question.rotors)
    progress.begin("reading the equations of motion")
    rows = _rows(question, sums, _usual_cutoff(question))
    if not any(each.moving.any() for each in rows):
        raise RunnerError(
            f"{question.recordings[0].path}: no joint moves fast enough in both directions, or no torque can be used: "
            f"{'; '.join(dict.fromkeys(text for each in rows for text in each.motion.unusable if text)) or 'slow'}."
        )
    fit = fit_logs(rows, "coulomb")
    payloads = [
        f"{change.log}: the payload seems to change by {change.mass:+.2g} kg at {change.time:.3g} s"
        for change in find_payload_changes(fit, rows)
    ]
    notes = [[*own, *_unusual(question.model, each)] for own, each in zip(question.notes, rows, strict=True)]
    return Examination(question, sums, rows, fit, list(_untold(question, sums, fit)), payloads, notes)


def _usual_cutoff(question: Question) -> float:
    return min(cutoff(recording.period) for recording in question.recordings)


def _rows(question: Question, sums: Sequence[Sum], frequency: float) -> list[LogRows]:
    model = question.model if question.rotors else question.model.with_armature(np.zeros(question.model.nq))
    return [
        read_rows(recording, model, sums, question.rotors, frequency, recording.path.name)
        for recording in question.recordings
    ]


def _unusual(model: RobotModel, rows: LogRows) -> Iterator[str]:
    """Yield what is unusual about the torques and accelerations of a log."""
    for joint, reason in enumerate(rows.motion.unusable):
        if reason:
            yield f"the torque of {model.joint_names[joint]} is left out: {reason}"
    still = [name for joint, name in enumerate(model.joint_names) if rows.motion.creeps(joint)]
    if still:
        yield (
            f"{', '.join(still)} {'do' if len(still) > 1 else 'does'} not move: at rest friction can be any torque, so "
            "these torques are left out"
        )
    noise = rows.motion.acceleration_noise
    swing = np.sqrt(np.mean(rows.motion.behind_filter(rows.motion.ddq) ** 2, axis=0))
    weak = [
        f"{name} ({share:.2g} times the noise)"
        for joint, (name, share) in enumerate(zip(model.joint_names, swing / np.maximum(noise, 1e-12), strict=True))
        if share < _NOISY and not rows.motion.creeps(joint)
    ]
    if weak:
        yield (
            f"the acceleration is small compared with the noise of the positions: {', '.join(weak)}; inertias come out "
            "small"
        )


def _untold(question: Question, sums: Sequence[Sum], fit: Fit) -> Iterator[Untold]:
    """Yield the parameters that a fit cannot tell, or only to an interval as wide as the torque."""
    names, joints = [each.name for each in sums], question.model.joint_names
    layout = fit.state.layout
    for column in range(layout.delay):
        if column not in fit.taken:
            name = name_of(layout, column, names, joints)
            mixed = [name_of(layout, fit.taken[place], names, joints) for place in _stand_for(fit, column)]
            reason = f"only in a sum with {_listed(mixed)}" if mixed else "the logs hold no motion that it acts in"
            yield Untold(name, reason, _motion_for(column, layout.base, sums, joints, len(TERMS[layout.kind])))
    for column in _weak(fit):
        name = name_of(layout, column, names, joints)
        share = _moved(fit, column)
        reason = f"its interval would move the torque by {100.0 * share:.0f} %"
        yield Untold(name, reason, _motion_for(column, layout.base, sums, joints, len(TERMS[layout.kind])))


def _listed(names: Sequence[str]) -> str:
    shown = [f"'{name}'" for name in names[:3]]
    return ", ".join(shown) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def _stand_for(fit: Fit, column: int) -> list[int]:
    """Return the places of the taken columns in whose sums a column is, if the column acts at all."""
    used = fit.weights > 0.0
    sizes = np.linalg.norm(fit.system.X[used] * fit.weights[used, None], axis=0)
    share = np.abs(fit.factors[:, column]) * sizes[fit.taken] / max(float(sizes[column]), 1e-300)
    return np.flatnonzero((share > _SUMMED) & (sizes[column] > 0.0)).tolist()


def _moved(fit: Fit, column: int) -> float:
    """Return the rms of the torque that the half-width of a value moves, over that of the torque, where it acts."""
    X = fit.system.X[:, column]
    acts = (fit.weights > 0.0) & (np.abs(X) > 0.0)
    rms = float(np.sqrt(np.mean(fit.system.y[acts] ** 2)))
    return float(fit.halves[column] * np.sqrt(np.mean(X[acts] ** 2))) / max(rms, 1e-300)


def _weak(fit: Fit) -> list[int]:
    delay = fit.state.layout.delay
    return [column for column in fit.taken if column != delay and not _moved(fit, column) <= _WEAK]


def _motion_for(column: int, base: int, sums: Sequence[Sum], joints: Sequence[str], terms: int) -> str:
    """Return a motion that would determine a column."""
    if column >= base:
        joint = joints[(column - base) // terms]
        return f"move {joint} in both directions, at several speeds and in several postures"
    unit, name = sums[column].unit, sums[column].name
    link = int(name.lstrip("cmIa")[: 2 if name.lstrip("cmIa")[:2].isdigit() else 1])
    if unit == "kg m" or unit == "kg":
        return f"turn link {link} through other directions against gravity"
    return f"accelerate {joints[link - 1]} harder, with the joints after it in other postures"


def identify(
    examined: Examination,
    outputs: Path,
    command: str,
    kind: FrictionKind | None = None,
    frequency: float | None = None,
) -> Identification:
    """Return the identification of an arm; it is not stored yet.

    Args:
        examined: The logs.
        outputs: Outputs folder.
        command: Command that makes it.
        kind: Kind of friction; None for the one that predicts unseen torques best.
        frequency: Cut-off on both sides of the equations, in Hz; None for the one that predicts unseen torques best.

    Raises:
        RunnerError: if the cut-off does not fit the rate of the rows.
    """
    question, sums, usual = examined.question, examined.sums, _usual_cutoff(examined.question)
    fastest = min(_FASTEST / recording.period for recording in question.recordings)
    if frequency is not None and not 0.5 <= frequency <= fastest:
        raise RunnerError(f"--cutoff: {frequency:g} Hz does not fit. Allowed: 0.5 to {fastest:.3g} Hz for these rows.")
    judged = examined.rows
    weights = joint_weights(examined.fit)
    progress.begin("choosing friction and cut-off")
    tried: list[tuple[Fit, HeldOut, Sequence[LogRows], float]] = []

    def attempt(own: FrictionKind, rows: Sequence[LogRows], at: float) -> int:
        fit = examined.fit if own == "coulomb" and rows is judged else fit_logs(rows, own)
        tried.append((fit, predict_held_out(fit, judged, weights), rows, at))
        return len(tried) - 1

    first = judged if frequency is None else _rows(question, sums, frequency)
    for own in (kind,) if kind else KINDS:
        attempt(own, first, usual if frequency is None else frequency)
    best = _chosen([held for _, held, _, _ in tried])
    if frequency is None:
        places = [best]
        for factor in _FACTORS:
            if (at := factor * usual) <= fastest:
                places.append(attempt(tried[best][0].state.layout.kind, _rows(question, sums, at), at))
        best = places[_chosen([tried[place][1] for place in places])]
    fit, held, rows, at = tried[best]
    second = second_method(fit)
    follows = _follows(fit, rows, question.model)
    alternatives = [
        Alternative(
            each.state.layout.kind, each_at, error.share(), float(error.squares.mean()),
            follows if number == best else _follows(each, each_rows, question.model), number == best,
        )
        for number, (each, error, each_rows, each_at) in enumerate(tried)
    ]  # fmt: skip
    layout = fit.state.layout
    digests = [digest_of(recording.path) for recording in question.recordings]
    said = (digests, [one.model_dump() for one in question.said], question.urdf, kind, frequency)
    base = _file_values(question, sums)
    wide = set(_weak(fit))
    return Identification(
        folder=place_of(outputs, said),
        command=command,
        robot=question.robot,
        urdf=question.urdf,
        side=question.recordings[0].side,
        currents=question.currents,
        kind=layout.kind,
        forced=kind is not None,
        frequency=at,
        parameters=[
            _parameter(question, sums, fit, column, second, base)
            for column in fit.taken
            if column != layout.delay and column not in wide
        ],
        untold=list(_untold(question, sums, fit)),
        joints=[_accuracy(question, rows, fit, held, base, joint) for joint in np.unique(held.system.joint).tolist()],
        held_out=held.share(),
        file=file_share(held.system, base),
        alternatives=alternatives,
        logs=[
            LogFacts(recording.path.name, digest, len(recording.t), recording.duration, recording.period,
                     one.warmth, list(notes))
            for recording, digest, one, notes in
            zip(question.recordings, digests, question.said, examined.notes, strict=True)
        ],
        follows=follows,
        payloads=examined.payloads,
        delay=fit.state.delay,
        delay_half=float(fit.halves[layout.delay]),
        block=fit.block,
        rank=len(fit.taken) - (layout.delay in fit.taken),
        condition=fit.condition,
        shapes=(fit.state.shapes * rows[0].motion.fastest).tolist() if layout.kind in SHAPED else [],
        date=datetime.now(UTC).date().isoformat(),
    )  # fmt: skip


def _chosen(held: Sequence[HeldOut]) -> int:
    """Return the first error than which none is clearly lower: by two deviations over the stretches, and by 1 %."""
    best = min(held, key=lambda each: float(each.squares.mean()))
    return next(place for place, each in enumerate(held) if not _is_clear(each.squares - best.squares, each.squares))


def _is_clear(gain: FloatArray, of: FloatArray) -> bool:
    deviation = float(gain.std(ddof=1) / np.sqrt(len(gain))) if len(gain) > 1 else np.inf
    return bool(gain.mean() > max(_DEVIATIONS * deviation, _BETTER * float(of.mean())))


def _follows(fit: Fit, rows: Sequence[LogRows], model: RobotModel) -> list[str]:
    return [
        f"{flag.follows} at {model.joint_names[flag.joint]} (t {flag.t:.1f}, chance up to {flag.limit:.1f})"
        for flag in find_flags(fit, rows)
    ]


def _file_values(question: Question, sums: Sequence[Sum]) -> FloatArray:
    model = question.model
    armature = model.armature if question.rotors else np.zeros(model.nq)
    full = np.concatenate([model.inertial_parameters, armature])
    return np.array([float(each.factors @ full) for each in sums])


def _parameter(
    question: Question, sums: Sequence[Sum], fit: Fit, column: int, second: SecondMethod, base: FloatArray,
) -> Parameter:  # fmt: skip
    layout, joints = fit.state.layout, question.model.joint_names
    names = [each.name for each in sums]
    inertial = column < layout.base
    joint, term = divmod(column - layout.base, len(TERMS[layout.kind]))
    unit = sums[column].unit if inertial else term_unit(TERMS[layout.kind][term], bool(question.model.prismatic[joint]))
    place = fit.taken.index(column)
    others = [other for other in range(layout.delay) if other not in fit.taken and place in _stand_for(fit, other)]
    return Parameter(
        name_of(layout, column, names, joints), unit, float(fit.state.values[column]), float(second.halves[column]),
        float(fit.white[column]), float(base[column]) if inertial else None, float(second.values[column]),
        bool(second.excess[column] > 0.0), bool(fit.spread[column]),
        [name_of(layout, each, names, joints) for each in others],
    )  # fmt: skip


def _accuracy(
    question: Question, rows: Sequence[LogRows], fit: Fit, held: HeldOut, base: FloatArray, joint: int
) -> JointAccuracy:
    system = fit.system
    own = np.flatnonzero(system.joint == joint)
    used = own[fit.weights[own] > 0.0]
    shown = used[np.unique(np.linspace(0, len(used) - 1, min(_SHOWN, len(used))).astype(int))] if len(used) else used
    signals: Mapping[str, list[FloatArray]] = {"position": [], "speed": []}
    ends = np.cumsum([0, *(recording.duration for recording in question.recordings)])
    for each in rows:
        signals["position"].append(each.motion.q[each.motion.kept, joint])
        signals["speed"].append(each.speed[:, joint])

    def values(parts: Sequence[FloatArray]) -> list[float]:
        return [float(f"{parts[log][row]:.6g}") for log, row in zip(system.log[shown], system.row[shown], strict=True)]

    layout = fit.state.layout
    load = system.X[shown, : layout.base] @ fit.state.values[: layout.base]
    return JointAccuracy(
        question.model.joint_names[joint], question.model.joint_units[joint], held.share(joint),
        file_share(held.system, base, joint), len(used), 1.0 - float(np.mean(system.moving[own])),
        float(np.mean(fit.outside[used])) if len(used) else 0.0,
        [float(f"{ends[log] + at:.6g}") for log, at in zip(system.log[shown], system.time[shown], strict=True)],
        values(signals["position"]), values(signals["speed"]),
        [float(f"{each:.6g}") for each in load], [float(f"{each:.6g}") for each in fit.rest[shown]],
    )  # fmt: skip
