"""Meanings of a log's columns by their names, and who wrote the log."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from runner.base.tables import NumericTable
from runner.recordings.messages import STAMP

Kind = Literal["time", "position", "reference", "velocity", "torque", "current", "tip"]
_Column = tuple[str, Kind, str, str, str]


@dataclass(frozen=True)
class Named:
    """Meaning of a column by its name.

    Attributes:
        column: The column.
        kind: The signal.
        group: Stem of the name: columns of one stem belong together.
        label: Joint, as the log has it: a name or a number; the axis of a tip; empty for a time.
        unit: Unit; empty if the name does not tell it.
        reason: Why.
        holds: Of a torque, see Column; empty if the name does not tell it.
        side: Of a torque, see Column; empty if the name does not tell it.
    """

    column: str
    kind: Kind
    group: str
    label: str
    unit: str
    reason: str
    holds: str = ""
    side: str = ""


@dataclass(frozen=True)
class _Writer:
    """A program that writes logs: its name, a column by which it is known, and its columns.

    Each is a pattern of names with the groups `label`, kind, unit and what a torque holds and where it is measured. A
    torque without a unit is in N m, or in N of a prismatic joint.
    `joints` are the names of columns with the name of the joint of each label.
    """

    name: str
    known: str
    columns: Sequence[_Column]
    joints: Sequence[str] = ()


_J = r"_(?P<label>\d+)"
_RTDE: Sequence[_Column] = (
    (r"timestamp", "time", "s", "", ""),
    (rf"actual_q{_J}", "position", "rad", "", ""),
    (rf"target_q{_J}", "reference", "rad", "", ""),
    (rf"actual_qd{_J}", "velocity", "rad/s", "", ""),
    (rf"target_moment{_J}", "torque", "", "commanded", ""),
    (rf"actual_current_as_torque{_J}", "torque", "", "", ""),
    (rf"actual_current{_J}", "current", "A", "", ""),
    (r"actual_TCP_pose_(?P<label>[012])", "tip", "m", "", ""),
)
WRITERS: Sequence[_Writer] = (
    _Writer("UR's RTDE client or ur-rtde's recorder", r"(actual|target)_q_0", _RTDE),
    _Writer(
        "mecademicpy",
        r"(Rt)?Target(JointPos|CartPos)_\w+",
        (
            (r"timestamp", "time", "us", "", ""),
            (rf"(Rt)?TargetJointPos{_J}", "reference", "deg", "", ""),
            (rf"(Rt)?(Act|Actual)?JointPos{_J}", "position", "deg", "", ""),
            (rf"(Rt)?(Act|Actual)?JointVel{_J}", "velocity", "deg/s", "", ""),
            (rf"(Rt)?(Act|Actual|Target)?JointTorq{_J}", "torque", "%", "", ""),
        ),
    ),
    _Writer(
        "libfranka or panda-python",
        r"(state\.|robot_state\.)?(tau_J|O_T_EE)[\[_. ]?\d+\]?",
        (
            (r"(state\.|robot_state\.)?time", "time", "", "", ""),
            (r"(state\.|robot_state\.)?q[\[_. ]?(?P<label>\d+)\]?", "position", "rad", "", ""),
            (r"(state\.|robot_state\.)?q_d[\[_. ]?(?P<label>\d+)\]?", "reference", "rad", "", ""),
            (r"(state\.|robot_state\.)?dq[\[_. ]?(?P<label>\d+)\]?", "velocity", "rad/s", "", ""),
            (r"(state\.|robot_state\.)?tau_J[\[_. ]?(?P<label>\d+)\]?", "torque", "", "torque", "link"),
            (r"(state\.|robot_state\.)?tau_J_d[\[_. ]?(?P<label>\d+)\]?", "torque", "", "without_gravity", "link"),
        ),
    ),
    _Writer(
        "ROS joint states",
        r".+\.(position|velocity|effort)",
        (
            (STAMP, "time", "s", "", ""),
            (r"(?P<label>.+)\.reference\.position", "reference", "rad", "", ""),
            (r"(?P<label>.+)\.feedback\.position", "position", "rad", "", ""),
            (r"(?P<label>.+)\.feedback\.velocity", "velocity", "rad/s", "", ""),
            (r"(?P<label>.+)\.feedback\.effort", "torque", "", "", ""),
            (r"(?P<label>(?!.*\.(reference|feedback)\.).+)\.position", "position", "rad", "", ""),
            (r"(?P<label>(?!.*\.(reference|feedback)\.).+)\.velocity", "velocity", "rad/s", "", ""),
            (r"(?P<label>(?!.*\.(reference|feedback)\.).+)\.effort", "torque", "", "", ""),
        ),
    ),
    _Writer(
        "rostopic echo -p",
        r"field\.((actual|feedback)\.)?positions?0",
        (
            (r"field\.header\.stamp", "time", "ns", "", ""),
            (r"field\.(desired|reference)\.positions(?P<label>\d+)", "reference", "rad", "", ""),
            (r"field\.((actual|feedback)\.)?positions?(?P<label>\d+)", "position", "rad", "", ""),
            (r"field\.((actual|feedback)\.velocities|velocity)(?P<label>\d+)", "velocity", "rad/s", "", ""),
            (r"field\.((actual|feedback)\.)?effort(?P<label>\d+)", "torque", "", "", ""),
        ),
        ("field.name{}", "field.joint_names{}"),
    ),
    _Writer(
        "PlotJuggler",
        r"/.+/(position|velocity|effort)",
        (
            (r"(__)?time", "time", "s", "", ""),
            (r"/(.+/)?(?P<label>[^/]+)/position", "position", "rad", "", ""),
            (r"/(.+/)?(?P<label>[^/]+)/velocity", "velocity", "rad/s", "", ""),
            (r"/(.+/)?(?P<label>[^/]+)/effort", "torque", "", "", ""),
        ),
    ),
    _Writer(
        "LeRobot",
        r"(observation\.state|action)\..+",
        (
            (r"timestamp", "time", "s", "", ""),
            (r"observation\.state\.(main_)?(?P<label>.+?)(\.pos)?", "position", "", "", ""),
            (r"action\.(main_)?(?P<label>.+?)(\.pos)?", "reference", "", "", ""),
        ),
    ),
)

_UNITS = {
    "deg": "deg", "degree": "deg", "degrees": "deg", "rad": "rad", "mrad": "mrad", "mm": "mm", "cm": "cm", "m": "m",
    "nm": "N m", "n m": "N m", "n*m": "N m", "n.m": "N m", "mnm": "mN m", "a": "A", "amp": "A", "ma": "mA",
    "s": "s", "sec": "s", "ms": "ms", "us": "us", "ns": "ns", "%": "%", "percent": "%",
}  # fmt: skip
_WORDS: Sequence[tuple[Kind, str]] = (
    (
        "reference",
        "q_d q_des des_q desired_q target_q q_target q_cmd cmd_q command cmd ref q_ref reference action "
        "setpoint target desired q_c position_command soll sollwert sollposition",
    ),
    ("velocity", "qd dq vel velocity speed velocities joint_velocities joint_vel joint_velocity qdot actual_qd"),
    (
        "torque",
        "tau torque effort moment efforts torques joint_torques "
        "tq tau_j joint_torque joint_effort tau_meas measured_tq tau_measured measured_torque",
    ),
    ("current", "current currents motor_current i cur actual_current"),
    (
        "position",
        "q pos position ist istwert istposition joint angle positions angles joint_positions joint_angles "
        "joint_pos joint_position joint_angle theta j q_meas actual_q "
        "measured_q state actual axis q_actual",
    ),
)
_STEMS: Mapping[str, Kind] = {stem: kind for kind, stems in _WORDS for stem in stems.split()}
_NEUTRAL = (  # words that leave a signal what it is
    "joint", "joints", "axis", "state", "states", "robot", "arm", "measured", "meas", "actual", "observation", "obs",
    "data", "feedback", "sensor", "sensors", "values", "msg", "message",
)  # fmt: skip
_COMMANDED = (
    "desired",
    "des",
    "target",
    "cmd",
    "command",
    "commanded",
    "ref",
    "reference",
    "goal",
    "setpoint",
    "action",
)
_NO_SIGNALS = ("j", "i", "joint", "axis", "state")  # if the only word next to the name of a joint
_LISTS = ("name", "names", "joint_names", "joint_name", "joints")  # of the joints of lists
_AXES = ("a", "ax", "axe", "achse", "asse", "eje", "gelenk")  # with a number: positions, if nothing else is one
_TIMES = (
    "time",
    "zeit",
    "temps",
    "tempo",
    "tiempo",
    "t",
    "timestamp",
    "stamp",
    "__time",
    "%time",
    "time_stamp",
    "elapsed",
    "header_stamp",
    "sec",
    "seconds",
)
_OF_TIME = ("time", "timestamp", "stamp", "zeit", "zeitstempel")  # words of a name, of a column that only grows
_HANDS = ("finger", "gripper", "hand", "knuckle")  # words before a joint's name, of what is not an arm
_TIPS = re.compile(r"(tip|tcp|ee|eef|tool|end_effector|laser|ee_pos|tcp_pose|position)?_?(?P<label>[xyz])")


def writer_of(columns: Sequence[str]) -> str:
    """Return the name of the program that wrote a log; empty if it is not known."""
    return next((writer.name for writer in WRITERS if _is_of(writer, columns)), "")


def _is_of(writer: _Writer, columns: Sequence[str]) -> bool:
    return any(re.fullmatch(writer.known, column) for column in columns)


def named(table: NumericTable, joints: Sequence[str] = ()) -> Iterator[Named]:
    """Yield the columns whose names have a meaning.

    Args:
        table: The log.
        joints: Names of the joints of the arm; a column of such a name holds its positions.
    """
    columns, units = list(table.columns), table.units
    for writer in WRITERS:
        if _is_of(writer, columns):
            meant = [found for column in columns if (found := _by_writer(writer, column, table.others))]
            yield from meant
            yield from () if _has_time(meant) else _times(table)
            return
    known = [
        _with_joint(each, table.others) for name in columns if (each := _by_words(name, units.get(name, ""), joints))
    ]
    yield from known
    yield from () if _has_time(known) else _times(table)
    if not any(each.kind in ("position", "reference") for each in known):
        for column in columns:
            words, unit = _words(column, units.get(column, ""))
            if match := re.fullmatch(rf"({'|'.join(_AXES)})_?(\d+)", "_".join(words)):
                yield Named(column, "position", match[1], match[2], unit, f"the name {column!r}, of an axis")


def _has_time(known: Sequence[Named]) -> bool:
    return any(one.kind == "time" for one in known)


def _times(table: NumericTable) -> Iterator[Named]:
    """Yield the columns that may be the time: by the whole name first, else by a word of it if they only grow."""
    others = [(name, *_words(name, table.units.get(name, ""))) for name in table.columns]
    exact = [(name, unit) for name, words, unit in others if _is_time("_".join(words), name)]
    growing = (
        (name, unit)
        for name, words, unit in others
        if set(words) & set(_OF_TIME)
        and not ((steps := np.diff(table.columns[name])) < 0.0).any()
        and (steps > 0.0).any()
    )
    for name, unit in exact or growing:
        yield Named(name, "time", "time", "", unit, f"the name {name!r}")


def _is_time(plain: str, column: str) -> bool:
    return plain in _TIMES or plain.removeprefix("_") in _TIMES or column.strip().lower() in _TIMES


def _by_writer(writer: _Writer, column: str, texts: Mapping[str, str]) -> Named | None:
    for pattern, kind, unit, holds, side in writer.columns:
        if match := re.fullmatch(pattern, column):
            label = match.groupdict().get("label") or ""
            if kind == "tip":
                label = "xyz"[int(label)]
            label = next((texts[name] for each in writer.joints if (name := each.format(label)) in texts), label)
            return Named(column, kind, pattern, label, unit, f"names of {writer.name}", holds, side)
    return None


def _words(column: str, unit: str) -> tuple[list[str], str]:
    """Return the words of a name in lower case, without its unit, and the unit."""
    text = re.sub(r"(?<=[a-z])(?=[A-Z][a-z]{2})", "_", column.strip()).lower()  # jointPosition
    if match := re.search(r"[\[(]\s*([a-z%*. ]+)\s*[\])]\s*$", text):
        unit, text = match[1], text[: match.start()].strip()
    words = [word for word in re.split(r"[\s_.\[\]()/:-]+", text) if word]
    if len(words) > 1 and words[-1] in _UNITS and not unit:
        unit = words.pop()
    return words, _UNITS.get(unit.lower().strip(), unit)


def _by_words(column: str, unit: str, joints: Sequence[str]) -> Named | None:
    """Return the meaning of a name that many programs might write."""
    words, unit = _words(column, unit)
    plain = "_".join(words)
    reason = f"the name {column!r}"
    of_joint = [joint for joint in joints if re.sub(r"\W", "_", joint.lower()) == plain]
    if len(of_joint) == 1:
        return Named(column, "position", "the joint's name", of_joint[0], unit, f"the name of the joint {of_joint[0]}")
    if _is_time(plain, column):
        return Named(column, "time", "time", "", unit, reason)
    if match := _TIPS.fullmatch(plain):
        return Named(column, "tip", "tip", match["label"], unit, reason)
    number = re.search(r"(\d+)(?!.*\d)", plain)
    stem = plain if number is None else (plain[: number.start()] + plain[number.end() :]).strip("_")
    stem = re.sub(r"^(joint|j|axis)_(?=.)|(?<=.)_(joint|j|axis)$", "", stem)
    kind = _kind(stem)
    if number is not None and kind is not None:
        return Named(column, kind, stem, number[1], unit, reason)
    for place in range(1, len(words)):  # the name of a joint before or after the signal
        for signal, joint in (("_".join(words[place:]), words[:place]), ("_".join(words[:place]), words[place:])):
            if signal in _STEMS and signal not in _NO_SIGNALS and not any(map(_is_signal, joint)):
                return Named(column, _STEMS[signal], signal, "_".join(joint), unit, reason)
    return None


def _is_signal(word: str) -> bool:
    return word in _STEMS and word not in ("joint", "axis", "j")


def _kind(stem: str) -> Kind | None:
    """Return the signal of a stem, also of one with further words, such as state_q."""
    if stem in _STEMS:
        return _STEMS[stem]
    words = [word for word in stem.split("_") if word and word not in _NEUTRAL]
    kind = _STEMS.get("_".join(word for word in words if word not in _COMMANDED))
    if any(word in _COMMANDED for word in words):
        return "reference" if kind == "position" else None
    return kind


def _with_joint(one: Named, texts: Mapping[str, str]) -> Named:
    """Return a meaning with the name of its joint, if a list of names stands next to the list of numbers."""
    stem, found, label = one.column.rpartition(".")
    if not found or label != one.label:
        return one
    beside = stem.rpartition(".")[0]
    lists = (f"{beside}.{name}.{label}" if beside else f"{name}.{label}" for name in _LISTS)
    return replace(one, label=next((texts[name] for name in lists if texts.get(name)), label))


def plain_name(name: str) -> str:
    """Return a joint's name without separators, and without "joint" at its end."""
    plain = re.sub(r"[^a-z0-9]", "", name.lower())
    return plain.removesuffix("joint") or plain


def joints_by_name(labels: Sequence[str], joints: Sequence[str]) -> tuple[dict[str, str], list[str]]:
    """Return the joint of each label that ends with a joint's name, and the labels of two arms; empty for one.

    Of labels for the same joint, those with one prefix for all joints count: `panda_joint1` and not
    `panda_finger_joint1`.

    Args:
        labels: Names of joints, as the log has them.
        joints: The joints of the arm.
    """
    arms: dict[str, dict[str, str]] = {}
    single: dict[str, str] = {}
    for label in dict.fromkeys(labels):
        plain = plain_name(label)
        fits = [joint for joint in joints if plain.endswith(plain_name(joint))]
        for joint in fits:
            arms.setdefault(plain.removesuffix(plain_name(joint)), {})[label] = joint
        fits = [joint for joint in fits if plain_name(joint) == plain] or fits
        if len(fits) == 1:
            single[label] = fits[0]
    complete = [prefix for prefix, found in arms.items() if set(found.values()) == set(joints)]
    complete = [prefix for prefix in complete if not any(word in prefix for word in _HANDS)] or complete
    known = {label: joint for prefix in complete for label, joint in arms[prefix].items()} or single
    if len(set(known.values())) < len(known) and not complete:
        most, *others = sorted(arms.values(), key=len, reverse=True)
        if all(len(most) >= 2 * len(other) for other in others):
            known = {label: joint for label, joint in single.items() if label in most or joint not in most.values()}
    return known, [label for label, joint in known.items() if list(known.values()).count(joint) > 1]
