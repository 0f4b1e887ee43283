"""Tables of joint states in ROS bags: files of ROS 1, MCAP, and SQLite of ROS 2, one after another.

A bag is streamed: no more of it than one chunk is held. Other topics, their encodings and the profile do not matter. A
file that a killed recorder left is read up to its last complete chunk.
"""

import bz2
import contextlib
import shutil
import sqlite3
import struct
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, NamedTuple

from runner.base.errors import RunnerError, nearest
from runner.base.limits import BAG, BAG_MEMORY, LOG_FILES, ExcessError, bounded_memory
from runner.base.sanitize import few, quoted
from runner.base.tables import NumericTable
from runner.recordings.messages import JointStates, decode, type_of

MAGIC = {b"#ROSBAG V": "ROS 1 bag", b"\x89MCAP0": "MCAP", b"SQLite format 3": "SQLite bag of ROS 2"}
"""First bytes of the files of bags, and their names."""

_ZSTD = b"\x28\xb5\x2f\xfd"
_EXTRA = "`.venv/bin/uv pip install -e '.[ros]'` in the checkout, or `pip install 'WHEEL[ros]'`, installs what reads it"


class _Raw(NamedTuple):
    """A message of a bag: topic, type, time of its record in ns, bytes."""

    topic: str
    type: str
    time: int
    data: bytes


@dataclass
class _Contents:
    """Topics met in a bag, with the types of their messages, and what could not be read."""

    topics: dict[str, str] = field(default_factory=dict)
    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)


def form_of(path: Path) -> str:
    """Return the name of the format of a bag's file, from its first bytes; empty for another file."""
    with path.open("rb") as file:
        head = file.read(16)
    if head.startswith(_ZSTD):
        return "compressed bag" if any(part in path.name for part in (".mcap", ".db3")) else ""
    return next((form for magic, form in MAGIC.items() if head.startswith(magic)), "")


def bag_files(path: Path) -> list[Path]:
    """Return the files of a bag, in order: the file itself, or those in its folder."""
    if path.is_file():
        return [path] if form_of(path) else []
    files = [file for file in sorted(path.iterdir(), key=_natural) if file.is_file()]
    if excess := LOG_FILES.excess(len(files)):
        raise RunnerError(f"{path}: {excess}")
    return [file for file in files if not file.name.endswith(("-wal", "-shm")) and form_of(file)]


def _natural(path: Path) -> list[tuple[int, str]]:
    """Return a key by which log_2 stands before log_10."""
    digits = "".join(c if c.isdigit() else " " for c in path.name).split()
    return [(int(part), "") for part in digits] + [(0, path.name)]


def read_bag(path: Path, topic: str | None) -> NumericTable:
    """Return the joint states of a bag.

    Messages that name other joints, as those of a gripper on the same topic, have rows of their own. A message counts
    at the time in its header, or where that is zero at the time at which it was recorded.

    Args:
        path: The bag, a file or a folder.
        topic: The topic; None if the bag has only one.

    Raises:
        RunnerError: if it cannot be read, or lacks the topic.
    """
    files = bag_files(path)
    if excess := BAG.excess(sum(file.stat().st_size for file in files)):
        raise RunnerError(f"cannot read {path}: it {excess}")
    contents, found = _Contents(), dict[str, JointStates]()
    try:
        with bounded_memory(BAG_MEMORY):
            for file in files:
                _collect(file, topic, contents, found)
            chosen = _chosen(path, topic, contents)
            columns = found[chosen].columns()
    except ImportError:
        raise RunnerError(f"{path} is a ROS bag; {_EXTRA}") from None
    except MemoryError as error:
        raise RunnerError(f"cannot read {path}: it takes more than {BAG_MEMORY.most:,} {BAG_MEMORY.of}") from error
    except (OSError, ValueError, sqlite3.Error) as error:
        raise RunnerError(f"cannot read {path}: {error}") from error
    kind = contents.topics[chosen].replace("/msg/", "/")
    others = [f"{name} ({kind})" for name, kind in contents.topics.items() if name != chosen]
    form = f"{form_of(files[0])}{f', {len(files)} files' if len(files) > 1 else ''}, {chosen} ({kind})"
    return NumericTable(path, form, columns, others=dict.fromkeys(others, ""), notes=tuple(contents.notes))


def _collect(file: Path, topic: str | None, contents: _Contents, found: dict[str, JointStates]) -> None:
    """Add the messages of a file; a note says where it breaks off."""
    form, before = form_of(file), sum(contents.counts.values())
    try:
        for raw in _messages(file, form, contents.topics):
            contents.topics.setdefault(raw.topic, raw.type)
            contents.counts[raw.topic] += 1
            kind = type_of(raw.type)
            if not kind or (topic is not None and raw.topic != topic):
                continue
            data = (
                _zstd().ZstdDecompressor().decompress(raw.data, BAG_MEMORY.most) if raw.data[:4] == _ZSTD else raw.data
            )
            message = decode(data, kind, old=form == "ROS 1 bag")
            found.setdefault(raw.topic, JointStates(kind)).add(message, raw.time)
    except (ExcessError, MemoryError, ImportError):
        raise
    except Exception as error:  # what ends early or is damaged raises almost anything
        read = sum(contents.counts.values()) - before
        if not read or "exceeds limit" in str(error):
            raise ValueError(
                f"{file.name} breaks off before its first message ({error or type(error).__name__})"
            ) from error
        contents.notes.append(
            f"{file.name} breaks off, as a killed recorder leaves it: {read:,} messages before are read"
        )


def _chosen(path: Path, topic: str | None, contents: _Contents) -> str:
    kinds = {name: type_of(kind) for name, kind in contents.topics.items() if type_of(kind)}
    topics = sorted(name for name, kind in kinds.items() if kind == "JointState") or sorted(kinds)
    if topic in kinds or (topic is None and len(topics) == 1):
        return topic or topics[0]
    if not kinds:
        there = f"; it has {few([f'{name} ({kind})' for name, kind in contents.topics.items()])}" * bool(
            contents.topics
        )
        raise RunnerError(
            f"{path}: no topic has messages of the type sensor_msgs/JointState or "
            f"control_msgs/JointTrajectoryControllerState{there}"
        )
    wrong = "has more than one topic of joint states" if topic is None else f"has no joint states on {quoted(topic)}"
    raise RunnerError(
        f"{path}: {wrong}{nearest(topic or '', list(kinds))}; say in the column map topic: one of {few(sorted(kinds))}"
    )


def _messages(file: Path, form: str, topics: dict[str, str]) -> Iterator[_Raw]:
    """Yield the messages of a file, and enter its topics in `topics`."""
    with contextlib.ExitStack() as stack:
        if form == "compressed bag":
            stream: Any = stack.enter_context(_zstd().open(file))
            if ".mcap" in file.name:
                yield from _of_mcap(stream, topics)
                return
            copy = stack.enter_context(tempfile.NamedTemporaryFile(suffix=".db3"))
            shutil.copyfileobj(stream, copy)  # a file beyond the limit of bounded_memory is refused
            copy.flush()
            yield from _of_sqlite(Path(copy.name), topics)
        elif form == "MCAP":
            yield from _of_mcap(stack.enter_context(file.open("rb")), topics)
        elif form == "ROS 1 bag":
            yield from _of_ros_1(stack.enter_context(file.open("rb")), topics)
        else:
            yield from _of_sqlite(file, topics)


def _zstd() -> Any:
    import zstandard

    return zstandard


def _of_mcap(stream: IO[bytes], topics: dict[str, str]) -> Iterator[_Raw]:
    from mcap.records import Channel, Message, Schema
    from mcap.stream_reader import StreamReader

    schemas: dict[int, str] = {}
    channels: dict[int, tuple[str, str]] = {}
    for record in StreamReader(stream, record_size_limit=BAG_MEMORY.most).records:
        if isinstance(record, Schema):
            schemas[record.id] = record.name
        elif isinstance(record, Channel):
            encoded = record.message_encoding in ("cdr", "ros1", "")
            kind = schemas.get(record.schema_id, record.message_encoding)
            channels[record.id] = (record.topic, kind if encoded else f"{kind} in {record.message_encoding}")
            topics.setdefault(*channels[record.id])
        elif isinstance(record, Message) and record.channel_id in channels:
            yield _Raw(*channels[record.channel_id], record.log_time, record.data)


def _of_sqlite(file: Path, topics: dict[str, str]) -> Iterator[_Raw]:
    address = file.resolve().as_uri()
    waiting = file.with_name(f"{file.name}-wal").exists()  # what a killed recorder had not yet moved into the file
    with contextlib.closing(sqlite3.connect(f"{address}?mode=ro{'' if waiting else '&immutable=1'}", uri=True)) as base:
        known = {row[0]: (str(row[1]), str(row[2])) for row in base.execute("SELECT id, name, type FROM topics")}
        topics.update({name: kind for name, kind in known.values() if name not in topics})
        wanted = [number for number, (_, kind) in known.items() if type_of(kind)]
        marks = ", ".join("?" * len(wanted))
        query = f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({marks})"  # noqa: S608 - only marks
        for number, time, data in base.execute(query, wanted):
            yield _Raw(*known[number], int(time), bytes(data))


def _of_ros_1(stream: IO[bytes], topics: dict[str, str]) -> Iterator[_Raw]:
    stream.readline(20)
    connections: dict[int, tuple[str, str]] = {}
    while length := stream.read(4):
        fields, body = _record(stream, length)
        operation = fields.get(b"op", b"")
        if operation == b"\x05":
            yield from _of_chunk(_unpacked(body, fields), connections, topics)
        else:
            yield from _of_record(operation, fields, body, connections, topics)


def _record(stream: IO[bytes], length: bytes) -> tuple[dict[bytes, bytes], bytes]:
    """Return the fields of the header of a record, and its data."""
    header = _read(stream, *struct.unpack("<I", length))
    body = _read(stream, *struct.unpack("<I", _read(stream, 4)))
    return _fields(header), body


def _read(stream: IO[bytes], count: int) -> bytes:
    if excess := BAG_MEMORY.excess(count):
        raise ValueError(f"a record {excess}")
    found = stream.read(count)
    if len(found) < count:
        raise EOFError("the file ends in a record")
    return found


def _fields(header: bytes) -> dict[bytes, bytes]:
    found, place = {}, 0
    while place < len(header):
        (length,) = struct.unpack_from("<I", header, place)
        name, _, value = header[place + 4 : place + 4 + length].partition(b"=")
        found[name] = value
        place += 4 + length
    return found


def _unpacked(body: bytes, fields: dict[bytes, bytes]) -> bytes:
    compression = fields.get(b"compression", b"none")
    if compression == b"bz2":
        return bz2.decompress(body)
    if compression == b"lz4":
        import lz4.frame  # type: ignore[import-untyped]

        return bytes(lz4.frame.decompress(body))
    return body


def _of_chunk(data: bytes, connections: dict[int, tuple[str, str]], topics: dict[str, str]) -> Iterator[_Raw]:
    place = 0
    while place < len(data):
        (length,) = struct.unpack_from("<I", data, place)
        fields = _fields(data[place + 4 : place + 4 + length])
        place += 4 + length
        (size,) = struct.unpack_from("<I", data, place)
        yield from _of_record(fields.get(b"op", b""), fields, data[place + 4 : place + 4 + size], connections, topics)
        place += 4 + size


def _of_record(
    operation: bytes,
    fields: dict[bytes, bytes],
    body: bytes,
    connections: dict[int, tuple[str, str]],
    topics: dict[str, str],
) -> Iterator[_Raw]:
    if operation == b"\x07":
        (number,) = struct.unpack("<I", fields[b"conn"])
        connections[number] = (fields[b"topic"].decode(), _fields(body).get(b"type", b"").decode())
        topics.setdefault(*connections[number])
    elif operation == b"\x02":
        (number,) = struct.unpack("<I", fields[b"conn"])
        sec, nanosec = struct.unpack("<II", fields[b"time"])
        yield _Raw(*connections[number], sec * 10**9 + nanosec, body)
