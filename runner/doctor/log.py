"""Examination of a log: its format, its columns with a meaning and a reason each, and what has to be asked."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from runner.base.errors import RunnerError
from runner.base.sanitize import few
from runner.base.tables import NumericTable
from runner.doctor.finding import DoctorFinding, ask_once
from runner.doctor.log_meanings import (
    BEYOND,
    UNNAMED,
    Meaning,
    empty_commands,
    empty_torques,
    joint_columns,
    meanings_of,
    spare_positions,
    time_of,
    unnamed,
    without_repeats,
)
from runner.doctor.log_motion import LogMotion, make_motion
from runner.doctor.log_names import named, writer_of
from runner.recordings.columns_map import ColumnsMap, MappedColumn, factors_of, read_map
from runner.recordings.consistency import check_consistency
from runner.recordings.files import read_log
from runner.recordings.other_meanings import HALF_TURN, WITHOUT_GRAVITY
from runner.recordings.recording import LONGEST_FILLED, Recording, to_recording
from runner.robots.model import RobotModel

_SHORTEST = 2.0  # s
_MOST_NAMED = 3  # further columns of a question that the column map repeats


@dataclass(frozen=True)
class LogExamination:
    """Result of an examination.

    Attributes:
        table: The log.
        writer: The program that wrote it; empty if it is not known.
        time: Column of the time and its unit; None without one.
        meanings: Columns with a meaning.
        findings: Observations and questions, the grade of the latter is "ask".
        recording: The signals; None while a position has to be asked for.
        motion: Motion for a run; None without one.
    """

    table: NumericTable
    writer: str
    time: Meaning | None
    meanings: Sequence[Meaning]
    findings: Sequence[DoctorFinding]
    recording: Recording | None
    motion: LogMotion | None

    @property
    def questions(self) -> list[DoctorFinding]:
        """Findings that have to be answered."""
        return [finding for finding in self.findings if finding.grade == "ask"]


def examine_log(
    path: Path,
    model: RobotModel | None,
    topic: str | None = None,
    episode: int | None = None,
    given: Path | None = None,
) -> LogExamination:
    """Examine a log.

    Args:
        path: The log, a file or a folder.
        model: The arm; None lists the columns only.
        topic: Of a ROS bag, see read_log.
        episode: Of a LeRobot data set, see read_log.
        given: A column map that is taken instead of a proposal.

    Raises:
        RunnerError: if it cannot be read, is shorter than 2 s, is of two arms, or does not move.
    """
    if given is not None:
        return _examine_given(path, model, given)
    table = read_log(path, None, topic, episode)
    names = list(named(table, () if model is None else model.joint_names))
    _refuse_infinite(table, [one.column for one in names])
    time, period = time_of(table, names)
    findings = [DoctorFinding("note", "rows", note) for note in table.notes]
    if time is not None and time.asked:
        findings.append(DoctorFinding("ask", time.column, time.asked))
    if model is None:
        meanings = [Meaning(one.column, {"kind": one.kind}, one.reason) for one in names if one.kind != "time"]
        return LogExamination(table, writer_of(list(table.columns)), time, meanings, findings, None, None)
    columns, repeats = without_repeats(table, joint_columns(table, names, model))
    spare = spare_positions(columns, model)
    if time is not None and time.asked:
        period = 0.0  # what is said of derivatives follows from the answer
    meanings = list(meanings_of(table, names, columns, model, period, path))
    positions = [one for one in meanings if "joint" in one.keys]
    if not positions:
        known = {one.column for one in names}
        meanings = [*meanings, *unnamed(table, [column for column in table.columns if column not in known])]
        if not any("joint" in one.keys for one in meanings):
            raise RunnerError(f"{path}: no columns of joint positions; its columns: {few(list(table.columns))}")
        text = f"no column's name tells a position of {few(model.joint_names)}"
        findings.append(DoctorFinding("ask", "columns", text, "fill in the map, and delete lines of other columns"))
        positions = meanings
    asked = [DoctorFinding("ask", one.column, one.asked) for one in meanings if one.asked and one.reason != UNNAMED]
    findings += ask_once(asked, [*table.columns, *model.joint_names], _MOST_NAMED)
    found = LogExamination(table, writer_of(list(table.columns)), time, meanings, findings, None, None)
    if (time is None or time.asked) or any(one.asked for one in positions):
        if time is None:
            findings.append(DoctorFinding("ask", "time", "no column of the time is known", "say rate: in Hz"))
        return _with_notes(found, "", repeats, spare)
    said = ColumnsMap.model_validate(map_of(found, topic, episode))
    return _with_notes(judge(found, model, said), empty_torques(columns), empty_commands(columns) or repeats, spare)


def _with_notes(found: LogExamination, torques: str, commands: str, spare: str) -> LogExamination:
    """Return an examination with notes on columns that are not taken, for the recording and for the motion."""
    texts = {"torques": torques, "commands": commands, "positions": spare}
    findings = [*found.findings, *(DoctorFinding("note", place, text) for place, text in texts.items() if text)]
    recording, motion = found.recording, found.motion
    if recording is not None:
        recording = replace(recording, notes=(*recording.notes, *filter(None, (spare, torques))))
    if motion is not None:
        motion = replace(motion, notes=(*motion.notes, *filter(None, (spare, commands))))
    return replace(found, findings=findings, recording=recording, motion=motion)


def _refuse_infinite(table: NumericTable, columns: Sequence[str]) -> None:
    for name in columns:
        rows = np.flatnonzero(np.isinf(table.columns[name]))
        if len(rows):
            raise RunnerError(f"{table.path}: {table.place(rows[0])}: {name} is infinite; allowed: a finite number")


def _examine_given(path: Path, model: RobotModel | None, given: Path) -> LogExamination:
    if model is None:
        raise RunnerError("--columns: needs --robot ROBOT, whose joints the column map names.")
    said, _ = read_map(given, model.joint_names, model.joint_units)
    table = read_log(path, None, said.topic, said.episode)
    table.require([*([said.time.column] if said.time else []), *said.columns])
    keys = said.model_dump(exclude_defaults=True)["columns"]
    meanings = [Meaning(name, keys[name], f"said in {given.name}") for name in said.columns]
    time = None if said.time is None else Meaning(said.time.column, {"unit": said.time.unit}, f"said in {given.name}")
    notes = [DoctorFinding("note", "rows", note) for note in table.notes]
    found = LogExamination(table, writer_of(list(table.columns)), time, meanings, notes, None, None)
    return judge(found, model, said, propose=False)


def judge(found: LogExamination, model: RobotModel, said: ColumnsMap, propose: bool = True) -> LogExamination:
    """Return an examination with what the signals say of each other, and the motion.

    Args:
        found: The columns of a log.
        model: The arm.
        said: Their meaning.
        propose: Whether torques without gravity and a turned base are taken where the signals show them, not asked for.

    Raises:
        RunnerError: if the signals cannot be read, or last less than 2 s.
    """
    recording = to_recording(found.table, said, factors_of(said, model.joint_names, model.joint_units), LONGEST_FILLED)
    if recording.duration < _SHORTEST:
        raise RunnerError(
            f"{recording.path}: the log lasts {recording.duration:.3g} s. Allowed: {_SHORTEST:g} s or more of motion."
        )
    findings = [DoctorFinding("note", "rows", note) for note in recording.notes if note not in found.table.notes]
    if recording.filled:
        gaps = f"{len(recording.filled)} gaps of up to {max(recording.filled):.3g} s"
        findings.append(DoctorFinding("note", "rows", gaps, "--fill-gaps fills them"))
    verdict = check_consistency(said.loaded(model), recording)
    if propose and verdict.questions and all(question.endswith(tuple(_PROPOSED)) for question in verdict.questions):
        proposal, without = _proposed(found, said, verdict.questions)
        return judge(proposal, model, without)
    findings += [DoctorFinding("ask", *_split(question)) for question in verdict.questions]
    findings += [DoctorFinding("note", "tip", note) for note in verdict.notes]
    findings += _still(model, recording)
    findings += _beyond(model, recording)
    findings = ask_once(findings, [*found.table.columns, *model.joint_names], model.nq)
    for joint, kinds in verdict.confirmed.items():
        text = f"its sign agrees with {' and '.join(_EVIDENCE[kind] for kind in kinds)}" if kinds else (
            "nothing in the log tells its sign"
        )  # fmt: skip
        findings.append(DoctorFinding("note", f"joint '{joint}'", text))
    open_positions = any(finding.grade == "ask" for finding in findings)
    motion = None if open_positions else make_motion(model, recording)
    recording = replace(recording, notes=(*recording.notes, *verdict.notes))
    findings += [] if motion is None else [DoctorFinding("note", "motion", note) for note in motion.notes]
    return replace(found, findings=[*found.findings, *findings], recording=recording, motion=motion)


def _without_gravity(column: MappedColumn) -> Mapping[str, object]:
    return {"holds": "without_gravity"} if column.torque else {}


def _half_turn(column: MappedColumn) -> Mapping[str, object]:
    return {"sign": -column.sign} if column.tip in ("x", "y") else {}


_PROPOSED: Mapping[str, tuple[str, str, Callable[[MappedColumn], Mapping[str, object]]]] = {
    WITHOUT_GRAVITY: ("torques", "holds: without_gravity is proposed", _without_gravity),
    HALF_TURN: ("tip", "sign: -1 is proposed for x and y", _half_turn),
}


def _proposed(found: LogExamination, said: ColumnsMap, questions: Sequence[str]) -> tuple[LogExamination, ColumnsMap]:
    """Return an examination and a map with the answers that the evidence gives."""
    for question in questions:
        ending = next(each for each in _PROPOSED if question.endswith(each))
        place, text, change = _PROPOSED[ending]
        changes = {name: change(column) for name, column in said.columns.items()}
        said = said.model_copy(
            update={"columns": {name: one.model_copy(update=changes[name]) for name, one in said.columns.items()}}
        )
        found = replace(
            found,
            meanings=[replace(one, keys={**one.keys, **changes.get(one.column, {})}) for one in found.meanings],
            findings=[*found.findings, DoctorFinding("note", place, question.removesuffix(ending).strip(), text)],
        )
    return found, said


_EVIDENCE = {"torque": "the torques", "tip": "the tip", "reference": "the commanded positions"}


def _split(question: str) -> tuple[str, str]:
    place, _, text = question.partition(": ")
    return (place, text) if text and place.startswith("columns") else ("log", question)


def _still(model: RobotModel, recording: Recording) -> Iterator[DoctorFinding]:
    q = recording.positions(model.joint_names)
    for joint, swing in zip(model.joint_names, () if q is None else np.ptp(q, axis=0).tolist(), strict=False):
        if swing < 1e-4:
            yield DoctorFinding(
                "note", f"joint '{joint}'", f"it does not move ({swing:.2g} rad): its friction cannot be found"
            )


def _beyond(model: RobotModel, recording: Recording) -> Iterator[DoctorFinding]:
    q = recording.positions(model.joint_names)
    if q is None:
        return
    lower, upper = model.position_limits
    for place, joint in enumerate(model.joint_names):
        out = max(float(q[:, place].max() - upper[place]), float(lower[place] - q[:, place].min()))
        if out > BEYOND * (upper[place] - lower[place]):
            yield DoctorFinding(
                "ask", f"joint '{joint}'",
                f"it leaves its limits of {lower[place]:.4g} to {upper[place]:.4g} by {out:.3g}",
                "correct unit, zero, sign or wrap of its column, or choose another robot",
            )  # fmt: skip


def map_of(found: LogExamination, topic: str | None, episode: int | None) -> dict[str, object]:
    """Return the column map of what needs no answer."""
    head: dict[str, object] = {}
    if topic is not None:
        head["topic"] = topic
    if episode is not None:
        head["episode"] = episode
    if found.time is not None:
        head["time"] = {"column": found.time.column, **found.time.keys}
    return {**head, "columns": {one.column: dict(one.keys) for one in found.meanings if not one.asked}}
