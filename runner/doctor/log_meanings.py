"""Meanings of a log's columns for an arm: each from its name and from its numbers, with what has to be asked."""

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.sanitize import few, quoted
from runner.base.tables import NumericTable
from runner.doctor.log_names import Named, joints_by_name, plain_name
from runner.recordings.lerobot import calibration_of
from runner.robots.model import RobotModel
from runner.schema.units import WRITTEN

_SLOWEST, _FASTEST = 2.0, 20_000.0  # Hz, of a log's rows
_EPOCHS = (("ns", 1e17), ("us", 1e14), ("ms", 1e11), ("s", 1e8))  # the least that a time since 1970 is, in each unit
_ALIKE = 0.1  # relative error of a ratio of speeds that tells a unit
BEYOND = 0.05
"""Share of a joint's range by which its positions may leave it."""
UNNAMED = "its name tells nothing"
"""Reason of a column that may be a position."""
ONLY_COMMANDS = "commanded, the log has no measured positions"
"""Reason of positions that are the commanded ones."""

_REPEATED = 0.99  # of the rows in which a joint or its command moves: its commands are copies of its positions
_EQUAL = 1e-9  # of a joint's swing
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


def time_of(table: NumericTable, names: Sequence[Named]) -> tuple[Meaning | None, float]:
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


@dataclass(frozen=True)
class JointColumns:
    """Columns of one signal of the joints.

    Attributes:
        filled: Those with numbers.
        empty: The joint of each column without a number.
        joints: The joint of each label.
    """

    filled: Sequence[Named]
    empty: Mapping[str, str]
    joints: Mapping[str, str]

    @property
    def empty_words(self) -> str:
        """Words for the columns without numbers."""
        return f"{few(list(self.empty))} {'has' if len(self.empty) == 1 else 'have'} no numbers"


def joint_columns(table: NumericTable, names: Sequence[Named], model: RobotModel) -> dict[str, JointColumns]:
    """Return the columns of each signal of the joints, by its kind.

    Args:
        table: The log.
        names: Its columns whose names have a meaning.
        model: The arm.

    Raises:
        RunnerError: if the log is of two arms or of another number of joints, or has no positions of a joint
            although it has their column.
    """
    joints = model.joint_names
    empty = {one.column for one in names if np.isnan(table.columns[one.column]).all()}
    chosen: dict[str, JointColumns] = {}
    for kind in ("position", "reference", "velocity", "torque", "current"):
        groups: dict[str, list[Named]] = {}
        for one in names:
            if one.kind == kind:
                groups.setdefault(one.group, []).append(one)
        best = max(groups.values(), key=lambda group: _count_filled(group, empty, joints), default=[])
        if best:
            chosen[kind] = _columns_of(table.path, best, empty, model)
    positions = chosen.get("position")
    if "reference" in chosen and (positions is None or not positions.filled):
        positions = chosen["reference"]
    if positions is not None and len(positions.filled) > 1 and not positions.joints:
        raise RunnerError(
            f"{table.path}: {_counted(positions.filled, model)}. Allowed: another robot, or `--columns MAP`."
        )
    if positions is not None and positions.filled and positions.empty:
        raise RunnerError(
            f"{table.path}: {positions.empty_words}: no position of {few(list(positions.empty.values()))}. Allowed: "
            "a log with the positions of all joints, or `--columns MAP` without the column."
        )
    return chosen


def _count_filled(group: Sequence[Named], empty: Set[str], joints: Sequence[str]) -> int:
    return min(sum(one.column not in empty for one in group), len(joints))


def _columns_of(path: Path, group: Sequence[Named], empty: Set[str], model: RobotModel) -> JointColumns:
    """Return the columns of a group; columns without numbers have a joint, too, so that the others keep theirs."""
    filled = [one for one in group if one.column not in empty]
    try:
        of = _joints_of(path, group, model)
    except RunnerError:  # two arms, one of them without numbers
        of = _joints_of(path, filled, model)
    alone = of if len(filled) == len(group) else _joints_of(path, filled, model)
    of = alone if len(alone) > len(of) else of
    return JointColumns(
        filled, {one.column: of[one.label] for one in group if one.column in empty and one.label in of}, of
    )


_SIGNALS = {"position": "positions", "reference": "commanded positions", "velocity": "speeds", "torque": "torques"}


def _counted(columns: Sequence[Named], model: RobotModel) -> str:
    """Return words for columns of another number of joints than the arm's."""
    names, signal = [one.column for one in columns], _SIGNALS.get(columns[0].kind, "currents")
    robot = model.pin_model.name or "the robot"
    return f"{signal} of {len(columns)} joints ({_span(names)}), and {robot} has {model.nq}"


def spare_positions(columns: Mapping[str, JointColumns], model: RobotModel) -> str:
    """Return a note on numbered positions of more joints than the arm has; empty if there are none."""
    found = columns.get("position") or columns.get("reference")
    if found is None or len(found.filled) <= model.nq or joints_by_name(list(found.joints), model.joint_names)[0]:
        return ""
    used = [one for one in found.filled if one.label in found.joints]
    used = sorted(used, key=lambda one: model.joint_names.index(found.joints[one.label]))
    return f"{_counted(found.filled, model)}: {_span([one.column for one in used])} are taken"


def empty_torques(columns: Mapping[str, JointColumns]) -> str:
    """Return a note on the torques without numbers; empty if all have some."""
    found = columns.get("torque")
    if found is None or not found.empty or ("current" in columns and not found.filled):
        return ""
    return f"{found.empty_words}: no torque of {few(list(found.empty.values()))}"


def empty_commands(columns: Mapping[str, JointColumns]) -> str:
    """Return a note on the commands without numbers, as the others are then not used; empty if all have some."""
    found = columns.get("reference")
    if found is None or not found.empty:
        return ""
    return f"{found.empty_words}; without all commands the motion follows the measured positions"


def without_repeats(table: NumericTable, columns: Mapping[str, JointColumns]) -> tuple[Mapping[str, JointColumns], str]:
    """Return the columns without commands, if some of these repeat the measured positions, and a note on it."""
    positions, commands = columns.get("position"), columns.get("reference")
    if positions is None or commands is None or commands.empty:
        return columns, ""
    measured = {positions.joints.get(one.label): one.column for one in positions.filled}
    repeated = [
        one.column for one in commands.filled
        if (column := measured.get(commands.joints.get(one.label, ""))) is not None
        and _repeats(table.columns[one.column], table.columns[column])
    ]  # fmt: skip
    if not repeated:
        return columns, ""
    said = "repeats the measured positions: it is not a command"
    if len(repeated) > 1:
        said = "repeat the measured positions: they are no commands"
    some = "; without all commands the motion follows the measured positions"
    text = f"{_span(repeated)} {said}{some if len(repeated) < len(commands.filled) else ''}"
    return {kind: found for kind, found in columns.items() if kind != "reference"}, text


def _repeats(commands: FloatArray, measured: FloatArray) -> bool:
    """Return whether commands equal positions in the rows that differ from the row before."""
    known = ~(np.isnan(commands) | np.isnan(measured))
    commands, measured = commands[known], measured[known]
    moves = np.flatnonzero((np.diff(commands) != 0.0) | (np.diff(measured) != 0.0)) + 1
    if not len(moves):
        return False
    equal = np.abs(commands - measured)[moves] <= _EQUAL * np.ptp(measured)
    return float(np.mean(equal)) >= _REPEATED


def _span(columns: Sequence[str]) -> str:
    return f"{columns[0]} to {columns[-1]}" if len(columns) > 2 else " and ".join(columns)


def meanings_of(
    table: NumericTable,
    names: Sequence[Named],
    columns: Mapping[str, JointColumns],
    model: RobotModel,
    period: float,
    path: Path,
) -> Iterator[Meaning]:
    """Yield the meaning of each column that a joint or the tip of an arm has.

    Args:
        table: The log.
        names: Its columns whose names have a meaning.
        columns: Those of its joints.
        model: The arm.
        period: Time between two rows, in s; 0 if it is not known.
        path: Its path.
    """
    joints = model.joint_names
    chosen = {kind: found for kind, found in columns.items() if found.filled}
    if "position" not in chosen and "reference" in chosen:
        commands = chosen.pop("reference")
        own = [replace(one, reason=f"{one.reason}; {ONLY_COMMANDS}") for one in commands.filled]
        chosen["position"] = replace(commands, filled=own)
    if "reference" in chosen and chosen["reference"].empty:
        chosen.pop("reference")
    if "torque" in chosen and len(chosen["torque"].joints) == len(joints):
        chosen.pop("current", None)  # the torque is known without a constant
    speeds = chosen.pop("velocity", None)
    speed_of = {} if speeds is None else {speeds.joints.get(one.label): one for one in reversed(speeds.filled)}
    for kind, found in chosen.items():
        for one in found.filled:
            joint = found.joints.get(one.label)
            if joint is None:
                continue
            place = joints.index(joint)
            if kind in ("position", "reference"):
                key = "joint" if kind == "position" else "reference"
                yield _position(table, one, key, joint, model, place, speed_of.get(joint), period, path)
            else:
                yield _torque(table, one, joint, model, place)
    for one in names:
        if one.kind == "tip" and not np.isnan(table.columns[one.column]).all():
            yield Meaning(one.column, {"tip": one.label, "unit": one.unit or _length(table, one, model)}, one.reason)


def unnamed(table: NumericTable, columns: Sequence[str]) -> Iterator[Meaning]:
    """Yield the columns that may be a joint's position, to be filled in: those that move, and do not only grow."""
    for column in columns:
        values = table.columns[column]
        steps = np.diff(values[~np.isnan(values)])
        if np.any(steps < 0.0):
            text = f"{np.nanmin(values):.4g} to {np.nanmax(values):.4g}: the position of which joint, in rad or deg?"
            yield Meaning(column, {"joint": None, "unit": None}, UNNAMED, text)


def _length(table: NumericTable, one: Named, model: RobotModel) -> str:
    return "m" if float(np.nanmax(np.abs(table.columns[one.column]))) < 4.0 * model.reach else "mm"


def _joints_of(path: Path, columns: Sequence[Named], model: RobotModel) -> dict[str, str]:
    """Return the joint of each label: by its name, else by its number, else by the order in the log."""
    labels, joints = [one.label for one in columns], model.joint_names
    by_name, twice = joints_by_name(labels, joints)
    if twice:
        raise RunnerError(f"{path}: holds two arms: {few(twice)} are the same joints. Use a log of one arm.")
    if len(by_name) == len(joints):
        return by_name
    numbers = {label: int(found[-1]) for label in labels if (found := re.findall(r"\d+", label))}
    ordered = sorted(numbers, key=lambda label: numbers[label])
    if len(numbers) == len(labels) and len(set(numbers.values())) == len(labels) and len(labels) >= len(joints):
        if len(labels) >= 2 * len(joints) and len(joints) > 2:
            raise RunnerError(
                f"{path}: {_counted(columns, model)}: two arms? Allowed: a log of one arm, another robot, or "
                "`--columns MAP`."
            )
        return dict(zip(ordered, joints, strict=False))
    if len(labels) == len(joints) and not by_name:
        return dict(zip(labels, joints, strict=True))
    return by_name


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
    slack = BEYOND * (upper - lower)
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
            choices = "rad nor in deg" if si == "rad" else "m nor in mm"
            asked = f"{low:.4g} to {high:.4g} lies in the limits of {joint} neither in {choices}; say its unit"
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
    motor = next((name for name in ranges if plain_name(name) == plain_name(one.label)), None)
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
