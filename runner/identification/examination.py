"""Examination of the logs of an arm: what they can determine, what not, and what is unusual about them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runner.base import progress
from runner.base.errors import RunnerError
from runner.base.quantities import quantity
from runner.identification.checks import payload_sentences
from runner.identification.fit import Fit, fit_logs, name_of
from runner.identification.friction_kinds import TERMS
from runner.identification.log_rows import LogRows, read_rows
from runner.identification.parameters import ParameterSum, base_sums
from runner.identification.result import Untold
from runner.identification.system import Layout
from runner.recordings.columns_map import ColumnsMap, read_map
from runner.recordings.consistency import check_consistency
from runner.recordings.equations import STANDSTILL
from runner.recordings.recording import Recording, read_recording
from runner.recordings.smoothing import cutoff
from runner.robots.model import RobotModel

_WEAK = 0.5  # of the rms of a torque that the interval of a determined parameter may move
_SUMMED = 0.1  # share of a column that another one stands for, from which on it is named
_NOISY = 10.0  # times the noise of its positions, below which the acceleration of a joint tells little


@dataclass(frozen=True)
class ArmLogs:
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
    def constants(self) -> dict[str, float]:
        """Torque constants in the first column map by joint; see torque_constants."""
        return torque_constants(self.said[0])

    @property
    def currents(self) -> list[int]:
        """Places of the joints whose torque constants are fitted: none, unless the known payloads of logs differ."""
        carried = [one.payload if one.payload is not None and one.payload.mass else None for one in self.said]
        if all(payload == carried[0] for payload in carried):
            return []
        return [place for place, joint in enumerate(self.model.joint_names) if joint in self.constants]


def torque_constants(said: ColumnsMap) -> dict[str, float]:
    """Return the torque constants of a column map by joint, in N m/A; none where torques are no currents."""
    columns = said.columns.values()
    return {str(each.torque): each.constant for each in columns if each.torque and each.constant is not None}


def read_question(
    robot: str, model: RobotModel, urdf: str, logs: Sequence[Path], maps: Sequence[Path], fill_gaps: float = 0.0
) -> ArmLogs:
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
        verdict = check_consistency(said.loaded(model), recording)
        if verdict.questions:
            raise RunnerError(f"{columns}: {' '.join(verdict.questions)}")
        recordings.append(recording)
        found.append(said)
        carried = [] if said.payload is None else [f"it carries {quantity(said.payload.mass, 'kg')}"]
        notes.append([*carried, *recording.notes, *verdict.notes])
    if len({(recording.side, recording.held) for recording in recordings}) > 1:
        raise RunnerError("--columns: the maps differ in side or torque. Allowed: torques of one kind in all logs.")
    logs_of_arm = ArmLogs(robot, model, urdf, recordings, found, notes)
    if logs_of_arm.currents and any(torque_constants(said) != logs_of_arm.constants for said in found):
        raise RunnerError(
            "--columns: the maps differ in constant, which the payloads determine. Allowed: the same in all maps."
        )
    return logs_of_arm


@dataclass(frozen=True)
class IdentificationExamination:
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

    question: ArmLogs
    sums: Sequence[ParameterSum]
    rows: Sequence[LogRows]
    fit: Fit
    untold: Sequence[Untold]
    payloads: Sequence[str]
    notes: Sequence[Sequence[str]]


def examine_logs(question: ArmLogs) -> IdentificationExamination:
    """Return the parameters that logs can determine, from their motion and a fit with viscous and Coulomb friction."""
    sums = base_sums(question.model, question.rotors)
    progress.begin("reading the equations of motion")
    rows = rows_of(question, sums, usual_cutoff(question))
    if not any(each.moving.any() for each in rows):
        raise RunnerError(
            f"{question.recordings[0].path}: no joint moves fast enough in both directions, or no torque can be used: "
            f"{'; '.join(dict.fromkeys(text for each in rows for text in each.motion.unusable if text)) or 'slow'}."
        )
    fit = fit_logs(rows, "coulomb", currents=question.currents)
    check_intervals(question, fit)
    payloads = list(payload_sentences(fit, rows))
    notes = [[*own, *_unusual(question.model, each)] for own, each in zip(question.notes, rows, strict=True)]
    return IdentificationExamination(question, sums, rows, fit, list(find_untold(question, sums, fit)), payloads, notes)


def check_intervals(question: ArmLogs, fit: Fit) -> None:
    """Check that the rows of a fit are enough for the interval of a parameter.

    Raises:
        RunnerError: if they are not.
    """
    delay = fit.state.layout.delay
    own = [column for column in fit.taken if column != delay]
    if np.isfinite(fit.halves[own]).any():
        return
    many, rows = int(np.sum(fit.weights > 0.0)), len(fit.weights)
    raise RunnerError(
        f"{_paths(question)}: too few rows are in the fit: {many} of {rows:,}, in which a joint moves one way, faster "
        f"than {STANDSTILL:.0%} of its fastest speed. Needed: more than {len(fit.taken) + 1}, at different times; move "
        "each joint in both directions, at several speeds."
    )


def _paths(question: ArmLogs) -> str:
    return ", ".join(str(recording.path) for recording in question.recordings)


def usual_cutoff(question: ArmLogs) -> float:
    """Return the cut-off frequency that suits the rate of all logs, in Hz."""
    return min(cutoff(recording.period) for recording in question.recordings)


def rows_of(question: ArmLogs, sums: Sequence[ParameterSum], frequency: float) -> list[LogRows]:
    """Return the equations at the rows of all logs, behind a low-pass with a cut-off in Hz."""
    model = question.model if question.rotors else question.model.with_armature(np.zeros(question.model.nq))
    return [
        read_rows(recording, model, sums, question.rotors, frequency, said.payload)
        for recording, said in zip(question.recordings, question.said, strict=True)
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


def find_untold(question: ArmLogs, sums: Sequence[ParameterSum], fit: Fit) -> Iterator[Untold]:
    """Yield the parameters that a fit cannot tell, or only to an interval as wide as the torque."""
    names, joints = [each.name for each in sums], question.model.joint_names
    layout = fit.state.layout
    for column in range(layout.delay):
        if column not in fit.taken:
            name = name_of(layout, column, names, joints)
            mixed = [name_of(layout, fit.taken[place], names, joints) for place in columns_in_sum(fit, column)]
            reason = f"only in a sum with {_listed(mixed)}" if mixed else "the logs hold no motion that it acts in"
            yield Untold(name, reason, _motion_for(column, layout, sums, joints))
    for column in find_weak(fit):
        name = name_of(layout, column, names, joints)
        share = _moved(fit, column)
        wide = f"its interval would move the torque by {100.0 * share:.0f} %"
        reason = wide if np.isfinite(share) else "the logs have too few rows for an interval"
        yield Untold(name, reason, _motion_for(column, layout, sums, joints))


def _listed(names: Sequence[str]) -> str:
    shown = [f"'{name}'" for name in names[:3]]
    return ", ".join(shown) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def columns_in_sum(fit: Fit, column: int) -> list[int]:
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


def find_weak(fit: Fit) -> list[int]:
    """Return the taken columns whose interval is as wide as the torque, or that have none."""
    delay = fit.state.layout.delay
    return [column for column in fit.taken if column != delay and not _moved(fit, column) <= _WEAK]


def _motion_for(column: int, layout: Layout, sums: Sequence[ParameterSum], joints: Sequence[str]) -> str:
    """Return a motion that would determine a column."""
    if column >= layout.constants:
        joint = joints[layout.currents[column - layout.constants]]
        return f"let {joint} turn the payload through other directions against gravity, or carry a heavier one"
    if column >= layout.base:
        joint = joints[(column - layout.base) // len(TERMS[layout.kind])]
        return f"move {joint} in both directions, at several speeds and in several postures"
    own = sums[column].column
    place = own // 10 if own < 10 * len(joints) else own - 10 * len(joints)
    if sums[column].unit in ("kg m", "kg"):
        return f"turn link {place + 1} through other directions against gravity"
    return f"accelerate {joints[place]} harder, with the joints after it in other postures"
