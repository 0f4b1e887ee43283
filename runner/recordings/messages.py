"""Joint states in ROS messages, decoded by our own description of two types.

Definitions in a bag are not used. `sensor_msgs/JointState` and `control_msgs/JointTrajectoryControllerState` begin with
a header and names of joints. Lists of numbers follow. Later fields of the message are not read.
"""

import struct
from array import array
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.limits import RECORDING_NUMBERS, RECORDING_ROWS, ExcessError

STAMP = "stamp"
"""Name of the column of the time, in s."""

_POINT = ("position", "velocity", "acceleration", "effort")
FIELDS: Mapping[str, Sequence[Sequence[str]]] = {
    "JointState": (("position", "velocity", "effort"),),
    "JointTrajectoryControllerState": tuple(
        tuple(f"{point}.{field}" for field in _POINT) for point in ("reference", "feedback")
    ),
}
"""Lists of numbers of each type of message, by part; `desired` and `actual` of old definitions have these names too."""

_MOST_JOINTS = 1000


def type_of(name: str) -> str:
    """Return the type that can be read, from a name such as sensor_msgs/msg/JointState; empty for another one."""
    package, _, last = name.rpartition("/")
    packages = {"JointState": "sensor_msgs", "JointTrajectoryControllerState": "control_msgs"}
    return last if last in packages and package.split("/")[0] == packages[last] else ""


class Message(NamedTuple):
    """A message: stamp of its header in ns, names of its joints, and its lists of numbers in the order of FIELDS."""

    stamp: int
    names: tuple[str, ...]
    lists: list[tuple[float, ...]]


def decode(data: bytes, kind: str, old: bool) -> Message:
    """Return the beginning of a message.

    Args:
        data: Its bytes: CDR, or those of ROS 1.
        kind: A key of FIELDS.
        old: Whether it is of ROS 1.

    Raises:
        ValueError: if the bytes are not such a message.
    """
    reader = _Reader(data, old)
    sec, nanosec = reader.integers(3)[1:] if old else reader.integers(2)
    reader.text()
    names = tuple(reader.text() for _ in range(reader.count()))
    lists: list[tuple[float, ...]] = []
    for part in FIELDS[kind]:
        lists += [reader.numbers() for _ in part]
        if len(part) == len(_POINT):
            reader.integers(2)  # time_from_start
    return Message(sec * 10**9 + nanosec, names, lists)


class _Reader:
    """Values one after another: CDR aligns them and ends texts by a zero, ROS 1 does neither."""

    def __init__(self, data: bytes, old: bool) -> None:
        self._data, self._old = data, old
        self._start = self._place = 0 if old else 4
        self._order = "<" if old or data[1:2] == b"\x01" else ">"

    def _unpack(self, code: str, count: int, size: int) -> tuple[int | float, ...]:
        if not self._old:
            self._place += (self._start - self._place) % size
        try:
            found = struct.unpack_from(f"{self._order}{count}{code}", self._data, self._place)
        except struct.error:
            raise ValueError("a message ends early, or is of another type than its topic says") from None
        self._place += count * size
        return found

    def integers(self, count: int) -> list[int]:
        return [int(value) for value in self._unpack("I", count, 4)]

    def count(self) -> int:
        (count,) = self.integers(1)
        if count > len(self._data):
            raise ValueError("a message has a list that is longer than itself")
        return count

    def text(self) -> str:
        length = self.count()
        found = self._data[self._place : self._place + length]
        self._place += length
        return found.rstrip(b"\0").decode("utf-8", "replace")

    def numbers(self) -> tuple[float, ...]:
        count = self.count()
        return self._unpack("d", count, 8) if count else ()


class JointStates:
    """Collector of messages of one topic.

    Args:
        kind: A key of FIELDS.
    """

    def __init__(self, kind: str) -> None:
        self._fields = [field for part in FIELDS[kind] for field in part]
        self._places: dict[tuple[str, ...], int] = {}
        self._stamps, self._groups = array("q"), array("H")
        self._numbers: list[array[float]] = []
        self._held = 0

    def add(self, message: Message, time: int) -> None:
        """Add a message, recorded at a time in ns, which counts if its header has none.

        Raises:
            ExcessError: if there are too many.
        """
        if len(message.names) > _MOST_JOINTS:
            raise ExcessError(f"a message names {len(message.names):,} joints; allowed: up to {_MOST_JOINTS:,}")
        group = self._places.setdefault(message.names, len(self._places))
        if group == len(self._numbers):
            self._numbers.append(array("d"))
        count = len(message.names)
        for values in message.lists:
            if len(values) == count:
                self._numbers[group].extend(values)
            else:
                self._numbers[group].extend([*values, *[np.nan] * count][:count])
        self._stamps.append(message.stamp or time)
        self._groups.append(group)
        self._held += count * len(self._fields)
        if excess := RECORDING_ROWS.excess(len(self._stamps)) or RECORDING_NUMBERS.excess(self._held):
            raise ExcessError(f"it {excess}")

    def columns(self) -> dict[str, FloatArray]:
        """Return the columns: STAMP from the first message on, and JOINT.FIELD of what was ever said; NaN elsewhere."""
        stamps, groups = np.array(self._stamps, dtype=np.int64), np.array(self._groups)
        found: dict[str, FloatArray] = {STAMP: (stamps - stamps[0]) * 1e-9}
        for names, group in self._places.items():
            rows = groups == group
            values = np.frombuffer(self._numbers[group]).reshape(-1, len(self._fields), max(1, len(names)))
            for place, joint in enumerate(names):
                for number, field in enumerate(self._fields):
                    if not np.isnan(values[:, number, place]).all():
                        column = found.setdefault(f"{joint}.{field}", np.full(len(stamps), np.nan))
                        column[rows] = values[:, number, place]
        return found
