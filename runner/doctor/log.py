"""Examination of a log: its format, its columns with a meaning and a reason each, and what has to be asked."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.sanitize import few, quoted
from runner.base.tables import NumericTable
from runner.doctor.finding import DoctorFinding
from runner.doctor.log_motion import LogMotion, make_motion
from runner.doctor.log_names import Named, named, writer_of
from runner.recordings.columns_map import ColumnsMap, factors_of, read_map
from runner.recordings.consistency import WITHOUT_GRAVITY, check_consistency
from runner.recordings.files import read_log
from runner.recordings.lerobot import calibration_of
from runner.recordings.recording import Recording, to_recording
from runner.robots.model import RobotModel
from runner.schema.units import WRITTEN

LONGEST_GAP = 0.1
"""Longest gap of a log that is filled, in s."""
_SHORTEST = 2.0  # s
_SLOWEST, _FASTEST = 2.0, 20_000.0  # Hz, of a log's rows
_EPOCHS = (("ns", 1e17), ("us", 1e14), ("ms", 1e11), ("s", 1e8))  # the least that a time since 1970 is, in each unit
_ALIKE = 0.1  # relative error of a ratio of speeds that tells a unit
_BEYOND = 0.05  # of a joint's range
ONLY_COMMANDS = "commanded, the log has no measured positions"
"""Reason of positions that are the commanded ones."""

_COUNTS = 4096.0  # of a turn of the motors that LeRobot calibrates


@dataclass(frozen=True)
class Meaning:
    """Meaning of a column.

    Attributes:
        column: The column.
        keys: Its keys in the column map; a value of None has to be filled in.
        reason: Why.
        asked: Information that is missing; empty if all is known. Such a column is written as a comment.
    """

    column: str
    keys: Mapping[str, object]
    reason: str
    asked: str = ""


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
    names = list(named(list(table.columns), table.units))
    time, period = _time(table, names)
    findings = [DoctorFinding("note", "rows", note) for note in table.notes]
    if time is not None and time.asked:
        findings.append(DoctorFinding("ask", time.column, time.asked))
    if model is None:
        meanings = [Meaning(one.column, {"kind": one.kind}, one.reason) for one in names if one.kind != "time"]
        return LogExamination(table, writer_of(list(table.columns)), time, meanings, findings, None, None)
    meanings = list(_meanings(table, names, model, period, path))
    positions = [one for one in meanings if "joint" in one.keys]
    if not positions:
        raise RunnerError(f"{path}: no columns of joint positions are known; its columns: {few(list(table.columns))}")
    findings += [DoctorFinding("ask", one.column, one.asked) for one in meanings if one.asked]
    found = LogExamination(table, writer_of(list(table.columns)), time, meanings, findings, None, None)
    if (time is None or time.asked) or any(one.asked for one in positions):
        if time is None:
            findings.append(DoctorFinding("ask", "time", "no column of the time is known", "say rate: in Hz"))
        return found
    said = ColumnsMap.model_validate(map_of(found, topic, episode))
    return judge(found, model, said)


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
    return judge(LogExamination(table, writer_of(list(table.columns)), time, meanings, notes, None, None), model, said)


def judge(found: LogExamination, model: RobotModel, said: ColumnsMap) -> LogExamination:
    """Return an examination with what the signals say of each other, and the motion.

    Args:
        found: The columns of a log.
        model: The arm.
        said: Their meaning.

    Raises:
        RunnerError: if the signals cannot be read, or last less than 2 s.
    """
    recording = to_recording(found.table, said, factors_of(said, model.joint_names, model.joint_units), LONGEST_GAP)
    if recording.duration < _SHORTEST:
        raise RunnerError(
            f"{recording.path}: the log lasts {recording.duration:.3g} s. Allowed: {_SHORTEST:g} s or more of motion."
        )
    findings = [DoctorFinding("note", "rows", note) for note in recording.notes if note not in found.table.notes]
    if recording.filled:
        gaps = f"{len(recording.filled)} gaps of up to {max(recording.filled):.3g} s"
        findings.append(DoctorFinding("note", "rows", gaps, "--fill-gaps fills them"))
    verdict = check_consistency(model, recording)
    gravity = [question for question in verdict.questions if question.endswith(WITHOUT_GRAVITY)]
    if gravity and len(verdict.questions) == 1:
        reason = gravity[0].removesuffix(WITHOUT_GRAVITY).strip()
        meanings = [
            replace(one, keys={**one.keys, "holds": "without_gravity"}) if "torque" in one.keys else one
            for one in found.meanings
        ]
        columns = {
            name: column.model_copy(update={"holds": "without_gravity"}) if column.torque else column
            for name, column in said.columns.items()
        }
        notes = [*found.findings, DoctorFinding("note", "torques", reason, "holds: without_gravity is proposed")]
        without = said.model_copy(update={"columns": columns})
        return judge(replace(found, meanings=meanings, findings=notes), model, without)
    findings += [DoctorFinding("ask", *_split(question)) for question in verdict.questions]
    findings += [DoctorFinding("note", "tip", note) for note in verdict.notes]
    findings += _still(model, recording)
    findings += _beyond(model, recording)
    for joint, kinds in verdict.confirmed.items():
        text = f"its sign agrees with {' and '.join(_EVIDENCE[kind] for kind in kinds)}" if kinds else (
            "nothing in the log tells its sign"
        )  # fmt: skip
        findings.append(DoctorFinding("note", f"joint '{joint}'", text))
    open_positions = any(finding.grade == "ask" for finding in findings)
    motion = None if open_positions else make_motion(model, recording)
    findings += [] if motion is None else [DoctorFinding("note", "motion", note) for note in motion.notes]
    return replace(found, findings=[*found.findings, *findings], recording=recording, motion=motion)


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
        if out > _BEYOND * (upper[place] - lower[place]):
            yield DoctorFinding(
                "ask", f"joint '{joint}'",
                f"it leaves its limits of {lower[place]:.4g} to {upper[place]:.4g} by {out:.3g}",
                "correct unit, zero, sign or wrap of its column, or choose another robot",
            )  # fmt: skip


def _time(table: NumericTable, names: Sequence[Named]) -> tuple[Meaning | None, float]:
    """Return the column of the time, and the usual time between two rows in s; 0 if that is not known."""
    times = [one for one in names if one.kind == "time"]
    if not times:
        return None, 0.0
    chosen = times[0]
    values = table.columns[chosen.column]
    values = values[~np.isnan(values)]
    steps = np.diff(values)
    steps = steps[steps > 0.0]
    if not len(steps):
        raise RunnerError(f"{table.path}: {chosen.column} does not grow. Allowed: a column of times.")
    step = float(np.median(steps))
    unit, reason, asked = _time_unit(chosen, float(values[0]), step)
    factor = float(WRITTEN["s"].get(unit, 1.0))
    return Meaning(chosen.column, {"unit": unit}, reason, asked), step * factor


def _time_unit(column: Named, first: float, step: float) -> tuple[str, str, str]:
    def rate(unit: str) -> float:
        return 1.0 / (step * float(WRITTEN["s"][unit]))

    units = [unit for unit in ("s", "ms", "us", "ns") if _SLOWEST <= rate(unit) <= _FASTEST]
    if column.unit in WRITTEN["s"]:
        if _SLOWEST <= rate(column.unit) <= _FASTEST:
            return column.unit, f"{column.reason}; rows come at {rate(column.unit):.4g} Hz", ""
        return column.unit, column.reason, (
            f"rows would come at {rate(column.unit):.3g} Hz if it is in {column.unit}"
            f"{f', at {rate(units[0]):.3g} Hz in {units[0]}' if units else ''}; say its unit"
        )  # fmt: skip
    for unit, least in _EPOCHS:
        if first > least:
            return unit, f"{column.reason}; times since 1970 in {unit}, rows come at {rate(unit):.4g} Hz", ""
    if step == 1.0:
        return "", column.reason, "it counts rows by 1: is it ms, or a number of rows? say unit: ms, or rate: in Hz"
    if not units:
        return "", column.reason, f"no unit gives a rate of a log: steps are {step:g}; say its unit"
    return units[0], f"{column.reason}; rows come at {rate(units[0]):.4g} Hz, which no other unit gives", ""


def _meanings(
    table: NumericTable, names: Sequence[Named], model: RobotModel, period: float, path: Path
) -> Iterator[Meaning]:
    joints = model.joint_names
    chosen: dict[str, tuple[list[Named], dict[str, str]]] = {}
    for kind in ("position", "reference", "velocity", "torque", "current"):
        groups: dict[str, list[Named]] = {}
        for one in names:
            if one.kind == kind and not np.isnan(table.columns[one.column]).all():
                groups.setdefault(one.group, []).append(one)
        best = max(groups.values(), key=lambda group: min(len(group), len(joints)), default=[])
        if best:
            chosen[kind] = best, _joints_of(path, [one.label for one in best], joints)
    if "position" not in chosen and "reference" in chosen:
        commands, of_label = chosen.pop("reference")
        chosen["position"] = [replace(one, reason=f"{one.reason}; {ONLY_COMMANDS}") for one in commands], of_label
    if "torque" in chosen and len(chosen["torque"][1]) == len(joints):
        chosen.pop("current", None)  # the torque is known without a constant
    for kind, (group, of) in chosen.items():
        speeds = chosen.get("velocity")
        for one in group:
            joint = of.get(one.label)
            if joint is None or kind == "velocity":
                continue
            place = joints.index(joint)
            speed = None if speeds is None else next((s for s in speeds[0] if speeds[1].get(s.label) == joint), None)
            if kind in ("position", "reference"):
                key = "joint" if kind == "position" else "reference"
                yield _position(table, one, key, joint, model, place, speed, period, path)
            else:
                yield _torque(table, one, joint, model, place)
    for one in names:
        if one.kind == "tip":
            yield Meaning(one.column, {"tip": one.label, "unit": one.unit or _length(table, one, model)}, one.reason)


def _length(table: NumericTable, one: Named, model: RobotModel) -> str:
    return "m" if float(np.nanmax(np.abs(table.columns[one.column]))) < 4.0 * model.reach else "mm"


def _joints_of(path: Path, labels: Sequence[str], joints: Sequence[str]) -> dict[str, str]:
    """Return the joint of each label: by its name, else by its number, else by the order in the log."""
    by_name: dict[str, str] = {}
    for label in labels:
        plain = _plain(label)
        fits = [joint for joint in joints if _plain(joint) == plain]
        fits = fits or [joint for joint in joints if plain.endswith(_plain(joint))]
        if len(fits) == 1:
            by_name[label] = fits[0]
    twice = [label for label in by_name if list(by_name.values()).count(by_name[label]) > 1]
    if twice:
        raise RunnerError(f"{path}: holds two arms: {few(twice)} are the same joints. Use a log of one arm.")
    if len(by_name) == len(joints):
        return by_name
    numbers = {label: int(found[-1]) for label in labels if (found := re.findall(r"\d+", label))}
    ordered = sorted(numbers, key=lambda label: numbers[label])
    if len(numbers) == len(labels) and len(set(numbers.values())) == len(labels) and len(labels) >= len(joints):
        if len(labels) >= 2 * len(joints) and len(joints) > 3:
            raise RunnerError(
                f"{path}: has {len(labels)} joint positions, and the robot {len(joints)}: two arms? Use a log of one."
            )
        return dict(zip(ordered, joints, strict=False))
    if len(labels) == len(joints) and not by_name:
        return dict(zip(labels, joints, strict=True))
    return by_name


def _plain(name: str) -> str:
    """Return a joint's name without separators, and without "joint" at its end."""
    plain = re.sub(r"[^a-z0-9]", "", name.lower())
    return plain.removesuffix("joint") or plain


def _position(
    table: NumericTable, one: Named, key: str, joint: str, model: RobotModel, place: int, speed: Named | None,
    period: float, path: Path,
) -> Meaning:  # fmt: skip
    values = table.columns[one.column]
    si = model.joint_units[place]
    unit, reasons, asked = one.unit, [one.reason], ""
    keys: dict[str, object] = {key: joint}
    lower, upper = (float(limit[place]) for limit in model.position_limits)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if "LeRobot" in one.reason:
        return _lerobot(one, keys, low, high, calibration_of(path))
    slack = _BEYOND * (upper - lower)
    fitting = [
        name for name in (("rad", "deg") if si == "rad" else ("m", "mm"))
        if lower - slack <= low * float(WRITTEN[si][name]) and high * float(WRITTEN[si][name]) <= upper + slack
    ]  # fmt: skip
    ratio = _ratio(values, None if speed is None else table.columns[speed.column], period)
    agree = speed is not None and speed.unit in ("", "rad/s") and ratio is not None
    if unit not in WRITTEN[si]:
        if agree and ratio is not None and abs(abs(ratio) * np.pi / 180.0 - 1.0) < _ALIKE:
            unit = "deg"
        else:
            unit = fitting[0] if fitting else ""
        if not unit:
            asked = f"{low:.4g} to {high:.4g} lies in the limits of {joint} neither in rad nor in deg; say its unit"
    factor = float(WRITTEN[si].get(unit, 1.0))
    if unit in fitting:
        reasons.append(f"{low * factor:.3g} to {high * factor:.3g} {si} lies in the limits of the joint")
    if ratio is not None and speed is not None and unit:
        per = ratio * factor / float(WRITTEN["rad/s"].get(speed.unit, 1.0)) if si == "rad" else ratio
        if abs(per - 1.0) < _ALIKE:
            reasons.append(f"its derivative agrees with {speed.column}")
        elif abs(per + 1.0) < _ALIKE:
            asked = f"its derivative is the opposite of {speed.column}: say the sign of {one.column}"
        elif abs(per) > 1.0 + _ALIKE or abs(per) < 1.0 - _ALIKE:
            asked = f"its derivative is {per:.3g} times {speed.column}: say the units of time and of {one.column}"
    keys["unit"] = unit or None
    return Meaning(one.column, keys, "; ".join(reasons), asked)


def _lerobot(
    one: Named, keys: dict[str, object], low: float, high: float, ranges: Mapping[str, Mapping[str, float]]
) -> Meaning:
    motor = next((name for name in ranges if _plain(name) == _plain(one.label)), None)
    if max(-low, high) > 100.5:
        unit = {"unit": "deg"}
        reason = f"{one.reason}; {low:.4g} to {high:.4g} is beyond a per cent"
        return Meaning(one.column, {**keys, **unit}, reason + "; degrees count from the middle of the calibrated range")
    if motor is not None:
        scale = (ranges[motor]["range_max"] - ranges[motor]["range_min"]) / 2.0 / _COUNTS * 2.0 * np.pi
        reason = f"{one.reason}; the calibration file gives the range of {motor}"
        return Meaning(one.column, {**keys, "unit": "%", "scale": round(scale, 6)}, reason)
    asked = (
        f'{low:.4g} to {high:.4g} is per cent of the calibrated range or degrees: say unit: deg, or unit: "%" and '
        "scale, the position at 100 % in rad (or lay the calibration file into meta/)"
    )
    return Meaning(one.column, {**keys, "unit": None}, one.reason, asked)


def _ratio(values: FloatArray, speeds: FloatArray | None, period: float) -> float | None:
    """Return the derivative of a column by a column of speeds; None if they do not follow each other."""
    if speeds is None or period <= 0.0 or len(values) < 10:
        return None
    rows = slice(None, None, max(1, len(values) // 20_000))
    every = max(1, len(values) // 20_000)
    own, other = values[rows], speeds[rows]
    slope = np.gradient(own, period * every)
    known = ~(np.isnan(slope) | np.isnan(other))
    slope, other = slope[known], other[known]
    if not len(slope) or not np.any(other) or not np.any(slope):
        return None
    correlation = float(slope @ other / (np.linalg.norm(slope) * np.linalg.norm(other)))
    return float(slope @ other / (other @ other)) if abs(correlation) > 0.9 else None


def _torque(table: NumericTable, one: Named, joint: str, model: RobotModel, place: int) -> Meaning:
    si = "N m" if model.joint_units[place] == "rad" else "N"
    values = table.columns[one.column]
    largest = float(np.nanmax(np.abs(values)))
    keys: dict[str, object] = {"torque": joint, "unit": one.unit or si}
    if one.holds:
        keys["holds"] = one.holds
    if one.side:
        keys["side"] = one.side
    if largest < 1e-9:
        return Meaning(
            one.column, keys, one.reason, f"is 0 in all rows (largest {largest:.3g}): the drive reports none"
        )
    if np.isnan(values).any() and np.isnan(values).mean() > 0.5:
        return Meaning(one.column, keys, one.reason, "is missing in most rows")
    limit = float(model.effort_limits[place])
    if one.kind == "current" or one.unit in ("A", "mA"):
        keys |= {"unit": "A", "constant": None}
        return Meaning(one.column, keys, one.reason, f"a current, up to {largest:.3g} A: say constant, in N m/A")
    if keys["unit"] == "%":
        keys["scale"] = None
        return Meaning(
            one.column, keys, one.reason,
            f"per cent of a maximum, up to {largest:.3g}: say scale, the torque at 100 % (the limit is {limit:g} {si})",
        )  # fmt: skip
    if keys["unit"] not in WRITTEN[si]:
        return Meaning(one.column, {**keys, "unit": None}, one.reason, f"its unit {quoted(keys['unit'])} is not known")
    return Meaning(one.column, keys, f"{one.reason}; up to {largest:.3g} {keys['unit']}, the limit is {limit:g} {si}")


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
