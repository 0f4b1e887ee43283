"""Numeric columns of recordings: CSV files, and joint states of ROS bags.

A bag is one of ROS 1, or MCAP or SQLite of ROS 2, one file or a folder. Its columns have the same form as in a CSV
file: `stamp`, in s, and JOINT.position, JOINT.velocity and JOINT.effort. Messages are read by ROS's published
definition of sensor_msgs/JointState. The definitions in the bag are not used, because rosbags would make code from
them.
"""

import csv
import math
from array import array
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.base.limits import BAG_MEMORY, RECORDING, RECORDING_ROW, RECORDING_ROWS, ExcessError, bounded_memory
from runner.base.sanitize import few, quoted
from runner.recordings import files_of

_SEPARATORS = ",;\t"
_MISSING = ("", "nan", "na", "null", "none")
_MOST_TOLD = 5  # problems of one file


def read_csv_columns(path: Path, wanted: Sequence[str]) -> dict[str, FloatArray]:
    """Return columns of a CSV file whose first line names them; commas, semicolons or tabs separate its cells.

    If commas do not separate cells, they may be decimal points.

    Args:
        path: The file.
        wanted: Names of the columns.

    Returns:
        Each column by its name; NaN for a cell that says that its number is missing.

    Raises:
        RunnerError: if it cannot be read, lacks a column, or has a cell without a number; names the line.
    """
    try:
        if excess := RECORDING.excess(path.stat().st_size):
            raise ExcessError(f"it {excess}")
        with path.open(encoding="utf-8-sig", newline="") as file:
            head = file.readline(RECORDING_ROW.most)
            file.seek(0)
            return _columns_of(path, file, max(_SEPARATORS, key=head.count), wanted)
    except (OSError, ExcessError, UnicodeDecodeError, csv.Error) as error:
        raise RunnerError(f"cannot read {path}: {error}") from error


def places_of(path: Path, wanted: Sequence[str], names: Sequence[str]) -> list[int]:
    """Return the indices of the wanted columns among those of a file.

    Raises:
        RunnerError: if one is not there, or stands there twice.
    """
    twice = [name for name in dict.fromkeys(names) if name in wanted and names.count(name) > 1]
    problems = [f"line 1 has the column {quoted(name)} more than once" for name in twice]
    missing = [f"{quoted(name)}{nearest(name, names)}" for name in wanted if name not in names]
    if missing:
        problems.append(f"has no column {few(missing)}; its columns: {few(list(names)) or 'none'}")
    if problems:
        raise _refused(path, problems)
    return [names.index(name) for name in wanted]


def _refused(path: Path, problems: Sequence[str], count: int = 0) -> RunnerError:
    """Return the error that names the first problems of a file; `count` is how many it has."""
    more = max(count, len(problems)) - _MOST_TOLD
    told = [*problems[:_MOST_TOLD], *([f"{more} more problems like these"] if more > 0 else [])]
    return RunnerError(f"{path}: {'; '.join(told)}")


def _rows(file: TextIO, separator: str) -> Iterator[list[str]]:
    """Yield the rows of a CSV file, none longer than allowed: quotes can join all lines to one."""
    held = 0

    def lines() -> Iterator[str]:
        nonlocal held
        for number, line in enumerate(file, start=1):
            held += len(line)
            if excess := RECORDING_ROWS.excess(number) or RECORDING_ROW.excess(held):
                raise ExcessError(f"it {excess}")
            yield line

    for row in csv.reader(lines(), delimiter=separator):
        held = 0
        yield row


def _columns_of(path: Path, file: TextIO, separator: str, wanted: Sequence[str]) -> dict[str, FloatArray]:
    rows = _rows(file, separator)
    names = [name.strip() for name in next(rows, [])]
    places = list(zip(places_of(path, wanted, names), wanted, strict=True))
    found = {name: array("d") for name in wanted}
    problems: list[str] = []
    told, empty = 0, []
    for line, cells in enumerate(rows, start=2):
        if not any(cell.strip() for cell in cells):
            empty.append(f"line {line}: {len(cells)} cells for {len(names)} columns")
            continue
        wrong, empty = empty, []  # at the end of the file they do no harm
        if len(cells) != len(names):
            wrong.append(f"line {line}: {len(cells)} cells for {len(names)} columns")
        for place, name in places if len(cells) == len(names) else ():
            text = cells[place].strip()
            found[name].append(_number(text if separator == "," else text.replace(",", ".")))
            if math.isnan(found[name][-1]) and text.lower() not in _MISSING:
                wrong.append(f"line {line}: {name} is {quoted(text)}; needed: a finite number")
        told += len(wrong)
        problems += wrong[: max(0, _MOST_TOLD - len(problems))]
    if problems:
        raise _refused(path, problems, told)
    return {name: np.array(column) for name, column in found.items()}


def _number(text: str) -> float:
    """Return the finite number in a cell; NaN where there is none."""
    try:
        number = float(text)
    except ValueError:
        return math.nan
    return number if math.isfinite(number) else math.nan


STAMP = "stamp"
_JOINT_STATE = "sensor_msgs/msg/JointState"
_FIELDS = ("position", "velocity", "effort")


def read_bag_columns(path: Path, topic: str | None, wanted: Sequence[str]) -> dict[str, FloatArray]:
    """Return columns of the joint states in a bag; NaN where a message says nothing of a joint.

    Messages that name no wanted joint, as those of a gripper on the same topic, are left out. A message counts at the
    time in its header, or where that is zero at the time at which it was recorded; times count from the first one.

    Args:
        path: The bag.
        topic: The topic of the joint states; None if the bag has only one.
        wanted: Names of the columns.

    Raises:
        RunnerError: if rosbags is not installed, the bag cannot be read, or lacks the topic or a column.
    """
    try:
        from rosbags import rosbag1, rosbag2, typesys
    except ImportError:
        raise RunnerError(f"{path} is a ROS bag; `pip install 'arm-control-runner[ros]'` installs its reader") from None
    old = path.suffix.lower() == ".bag"
    store = typesys.get_typestore(typesys.Stores.ROS1_NOETIC if old else typesys.Stores.ROS2_HUMBLE)
    deserialize = store.deserialize_ros1 if old else store.deserialize_cdr
    try:
        if excess := RECORDING.excess(sum(file.stat().st_size for file in files_of(path))):
            raise ExcessError(f"it {excess}")
        with bounded_memory(BAG_MEMORY), (rosbag1 if old else rosbag2).Reader(path) as reader:
            connections = [each for each in reader.connections if each.msgtype == _JOINT_STATE]
            chosen = _topic(path, topic, sorted({each.topic for each in connections}))
            read = reader.messages([each for each in connections if each.topic == chosen])
            return _columns_of_messages(
                path, ((time, deserialize(data, _JOINT_STATE)) for _, time, data in read), wanted
            )
    except RunnerError:
        raise
    except MemoryError as error:
        raise RunnerError(f"cannot read {path}: it takes more than {BAG_MEMORY.most:,} {BAG_MEMORY.of}") from error
    except Exception as error:  # a damaged bag raises almost anything in rosbags
        raise RunnerError(f"cannot read {path}: {error or type(error).__name__}") from error


def _topic(path: Path, topic: str | None, topics: Sequence[str]) -> str:
    if topic in topics or (topic is None and len(topics) == 1):
        return topic or topics[0]
    if not topics:
        raise RunnerError(f"{path}: no topic has messages of the type {_JOINT_STATE}")
    wrong = "has more than one topic of joint states" if topic is None else f"has no joint states on {quoted(topic)}"
    raise RunnerError(
        f"{path}: {wrong}{nearest(topic or '', topics)}; say in the column map topic: one of {few(list(topics))}"
    )


def _columns_of_messages(
    path: Path, messages: Iterator[tuple[int, Any]], wanted: Sequence[str]
) -> dict[str, FloatArray]:
    signals = [name.rpartition(".") for name in wanted if name != STAMP]
    joints = {joint for joint, _, _ in signals}
    found = {name: array("d") for name in wanted}
    known: dict[str, None] = {}
    first: int | None = None
    for number, (time, message) in enumerate(messages, start=1):
        if excess := RECORDING_ROWS.excess(number):
            raise ExcessError(f"it {excess}")
        known.update(dict.fromkeys(message.name))
        if joints.isdisjoint(message.name):
            continue
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec or time
        first = stamp if first is None else first
        places = {joint: place for place, joint in enumerate(message.name)}
        for joint, _, field in signals:
            values = getattr(message, field) if field in _FIELDS else ()
            place = places.get(joint, len(values))
            found[f"{joint}.{field}"].append(float(values[place]) if place < len(values) else np.nan)
        if STAMP in found:
            found[STAMP].append((stamp - first) * 1e-9)
    places_of(path, wanted, [STAMP, *(f"{joint}.{field}" for joint in known for field in _FIELDS)])
    return {name: np.array(column) for name, column in found.items()}
