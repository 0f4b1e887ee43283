"""Stored files: digests, sealed JSON, and the folder of a job, which stored runs and calibrations have in common.

A damaged file is detected when it is read, and never used. A digest detects accidents: a flipped bit, half a file, an
edit. It does not detect forgery, because anyone can compute a new digest.
"""

import hashlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import yaml

from runner.base.atomic import refuse_links, write_atomically
from runner.base.bounded_json import decode_json
from runner.base.bounded_yaml import STORED, YamlError, read_yaml
from runner.base.errors import StoreError
from runner.base.limits import RECORD, RECORD_VALUES, ExcessError
from runner.base.memory import Memory

SCHEMA = 3
"""Schema of every stored file; files of another schema are rejected."""

MEND = "run it again to repair it"
_NAMED = ("runs", "calibrations")  # parents of folders that have the name of their job; a copy may have any name
# Keys for the location, name and report of a run. They do not affect the simulation.
_LEFT_OUT = ("caveats", "limits", "outputs", "preset", "spec", "sweep")
_TRAJECTORIES = Memory(256)
_SCALARS = frozenset({bool, float, int, str})
# The runner writes no aliases and few braces, and only these can exceed the bounds of YAML.
_UNUSUAL = re.compile(r"[&?]|\[(?!\])|\{(?!\})|^ {60}|(- ){4}", re.M)
_BLANK = "0" * 64
_DIGEST = re.compile(rb'"digest": "([0-9a-f]{64})"')
_LINE_HEX = 32

_encode = json.JSONEncoder().encode
encode_finite = json.JSONEncoder(allow_nan=False).encode
"""Return the JSON text of a value, as `json.dumps` does.

Raises:
    ValueError: if a number is not finite.
"""


class DamagedError(StoreError):
    """A stored file that differs from what was written."""


class SchemaError(StoreError):
    """A stored file of another schema, written by another version.

    Args:
        path: The file.
        schema: Its schema.
    """

    def __init__(self, path: Path, schema: object) -> None:
        super().__init__(
            f"cannot read {path}: it has schema {schema}, and this version reads schema {SCHEMA}; make it again in "
            "another folder, as in outputs=FOLDER"
        )


def digest(content: bytes) -> str:
    """Return the digest of a file's content: SHA-256."""
    return hashlib.sha256(content).hexdigest()


def sealed_json(content: Mapping[str, Any]) -> bytes:
    """Return content as JSON, with its schema and digest first; see `read_json`."""
    return seal_text(json.dumps({**head(), **content}, indent=1, allow_nan=False) + "\n")


def head() -> dict[str, Any]:
    """Return the first entries of sealed JSON: the schema, and a placeholder for the digest."""
    return {"schema": SCHEMA, "digest": _BLANK}


def seal_text(text: str) -> bytes:
    """Return JSON with its placeholder replaced by a digest over the rest of it."""
    content = text.encode()
    return content.replace(_BLANK.encode(), digest(content).encode(), 1)


def read_json(path: Path, remedy: str) -> dict[str, Any]:
    """Return the content and schema of a file that `sealed_json` encoded, after a check of its digest.

    Args:
        path: The file.
        remedy: Advice on how to restore the file, which ends the error message.

    Raises:
        DamagedError: if the file differs from what was written; names the file and the remedy.
        SchemaError: if the file has another schema.
    """
    try:
        if excess := RECORD.excess(path.stat().st_size):
            raise ExcessError(excess)
        content = path.read_bytes()
        if excess := RECORD_VALUES.excess(sum(map(content.count, (b",", b":", b"[", b"{")))):
            raise ExcessError(excess)
        record = decode_json(content)
    except OSError as error:
        raise DamagedError(f"cannot read {path}: {error.strerror}; {remedy}") from error
    except ValueError as error:
        raise DamagedError(f"cannot read {path}: it is damaged: {_first_characters(error)}; {remedy}") from error
    schema = record.get("schema") if isinstance(record, dict) else None
    if type(schema) is not int:
        raise DamagedError(f"cannot read {path}: it is damaged: it names no schema; {remedy}")
    if not _is_whole(content) and (schema == SCHEMA or "digest" in record):
        raise DamagedError(f"cannot read {path}: it is damaged: its content has another digest than it says; {remedy}")
    if schema != SCHEMA:
        raise SchemaError(path, schema)
    del record["digest"]
    return dict(record)


def read_file(path: Path, files: Mapping[str, str], remedy: str) -> bytes:
    """Return the content of a file whose digest is in the record of the same folder.

    Args:
        path: The file.
        files: Digests by file name.
        remedy: Advice on how to restore the file, which ends the error message.

    Raises:
        DamagedError: if the file is missing, or differs from what was written.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise DamagedError(f"cannot read {path}: {error.strerror}; {remedy}") from error
    if files.get(path.name) != digest(content):
        raise DamagedError(f"cannot read {path}: it is damaged: its content has another digest than stored; {remedy}")
    return content


class Lines:
    """Chain of digests in a file that grows line by line.

    Each line begins with half of a SHA-256 over the digest of the previous line and the content of the line. The chain
    detects a line that was changed, removed or moved.
    """

    def __init__(self) -> None:
        self._last = ""

    def seal(self, text: str) -> str:
        """Return the next line, without a line break."""
        self._last = digest(f"{self._last}\n{text}".encode())[:_LINE_HEX]
        return f"{self._last} {text}"

    def read(self, content: bytes) -> Iterator[str]:
        """Yield the content of each line of a file; skip a last line that its writer has not completed.

        Raises:
            ValueError: at the first line that differs from what was written.
        """
        for number, line in enumerate(content.decode().split("\n")[:-1], start=1):
            own = line.partition(" ")[2]
            if self.seal(own) != line:
                raise ValueError(f"line {number} has another digest than it says")
            yield own


def _is_whole(content: bytes) -> bool:
    found = _DIGEST.search(content)
    if found is None:
        return False
    blank = content[: found.start(1)] + _BLANK.encode() + content[found.end(1) :]
    return digest(blank).encode() == found[1]


def _first_characters(error: Exception) -> str:
    return " ".join(str(error).split())[:200]


class JsonTexts:
    """Encoder with the output of `json.dumps` that encodes a repeated value below the root only once.

    A value is recognized as the same object under the same key. It must not be changed between calls.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[str, int], str] = {}
        self._kept: list[object] = []  # keeps the objects alive, so that their ids stay unique

    def of(self, content: Mapping[str, Any]) -> str:
        """Return the JSON of a mapping."""
        known = self._known.get
        entries = [known((key, id(value))) or self._entry(key, value) for key, value in content.items()]
        return "{" + ", ".join(entries) + "}"

    def _entry(self, key: str, value: object) -> str:
        entry = f"{_encode(key)}: {_encode(value)}"
        self._kept.append(value)
        self._known[key, id(value)] = entry
        return entry


@dataclass(frozen=True, eq=False)
class Stored:
    """A job's folder, named by its content hash.

    Attributes:
        folder: The folder.
        config: Resolved config.
        record: Results and provenance.
    """

    folder: Path
    config: Mapping[str, Any]
    record: Mapping[str, Any]

    @property
    def hash(self) -> str:
        """Content hash, the name of the folder."""
        return self.folder.name

    @property
    def outputs(self) -> Path:
        """Outputs folder that contains the job."""
        return self.folder.parent.parent

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Commit, versions, machine, seed, command, warnings, and further entries of the kind of job."""
        provenance: Mapping[str, Any] = self.record["provenance"]
        return provenance

    @cached_property
    def urdf(self) -> str:
        """Simulated URDF.

        Raises:
            DamagedError: if the file is missing or damaged.
        """
        return decode_text(self.folder / "robot.urdf", self.read("robot.urdf"))

    def read(self, name: str) -> bytes:
        """Return the content of a file of the job, other than the record.

        Raises:
            DamagedError: if the file is missing or damaged.
        """
        return read_file(self.folder / name, self.record["files"], MEND)


def simulated_part(resolved: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a config that determine the result; a data file is given by its content, not its name."""
    kept = {key: value for key, value in resolved.items() if key not in _LEFT_OUT}
    trajectory = kept.get("trajectory")
    if isinstance(trajectory, Mapping) and trajectory.get("kind") == "from_file":
        kept["trajectory"] = _TRAJECTORIES.recall(_without_file_name, trajectory)
    return kept


def _without_file_name(trajectory: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in trajectory.items() if key != "file"}


def write_job(
    folder: Path, record_name: str, record: Mapping[str, Any], files: Mapping[str, bytes], flushed: Sequence[str] = ()
) -> dict[str, Any]:
    """Store a job's files and return the record with their digests. The record is last: it marks the job as complete.

    Args:
        folder: The job's folder.
        record_name: File name of the record.
        record: Results and provenance.
        files: Content of the other files by name.
        flushed: Names of files that are on the disk on return. A power cut may leave the others empty.

    Raises:
        StoreError: if a file cannot be written.
    """
    refuse_links(folder.parent.parent, folder)
    for name, content in files.items():
        write_atomically(folder / name, content, flush=name in flushed)
    digests = {name: digest(content) for name, content in files.items()}
    whole = {"name": folder.name, "files": digests, **record}
    write_atomically(folder / record_name, sealed_json(whole))
    return {"schema": SCHEMA, **whole}


def read_job(folder: Path, record_name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return a job's record and config.

    Args:
        folder: The job's folder.
        record_name: File name of the record.

    Raises:
        DamagedError: if one of the files is missing or damaged.
    """
    record = _read_record(folder / record_name)
    path = folder / "config.yaml"
    text = decode_text(path, read_file(path, record["files"], MEND))
    try:
        config = _read_parts(text) if len(text) <= STORED.size.most else None
        config = read_yaml(text, path) if config is None else config
    except (yaml.YAMLError, YamlError) as error:
        raise DamagedError(f"cannot read {path}: it is damaged: {' '.join(str(error).split())}; {MEND}") from error
    if not isinstance(config, dict):
        raise DamagedError(f"cannot read {path}: it is damaged: it holds no config; {MEND}")
    return record, config


def _read_parts(text: str) -> Any:
    """Return the YAML content of a stored config; None if only a bounded reader may read it.

    Its top-level keys are parsed one by one, and equal ones once.
    """
    config: dict[str, Any] = {}
    for part in filter(None, re.split(r"^(?=\S)", text, flags=re.MULTILINE)):
        found = _read_part(part)
        if not isinstance(found, dict):
            return None
        config |= _copied(found)
    return config


@lru_cache(512)
def _read_part(text: str) -> Any:
    """Return YAML content without its bounds, which take time; None where it has what can exceed them."""
    return None if _UNUSUAL.search(text) else yaml.load(text, yaml.CSafeLoader)


def _copied(value: Any) -> Any:
    """Return a copy of YAML content, whose containers are dictionaries and lists; it is faster than `copy.deepcopy`."""
    if isinstance(value, dict):
        return {key: each if type(each) in _SCALARS else _copied(each) for key, each in value.items()}
    return [_copied(each) for each in value] if isinstance(value, list) else value


def check_job(folder: Path, record_name: str) -> dict[str, Any]:
    """Return a job's record after a check of the digests of all its files; faster than parsing them.

    Raises:
        DamagedError: if one of the files is missing or damaged.
    """
    record = _read_record(folder / record_name)
    for name in record["files"]:
        read_file(folder / name, record["files"], MEND)
    return record


def _read_record(path: Path) -> dict[str, Any]:
    record = read_json(path, MEND)
    if not isinstance(record.get("files"), dict):
        raise DamagedError(f"cannot read {path}: it is not the record of a job: it has no digests of its files; {MEND}")
    folder = path.parent.absolute()
    if folder.parent.name in _NAMED and record.get("name", folder.name) != folder.name:
        raise DamagedError(f"cannot read {path}: it is the record of another job, {record['name']}; {MEND}")
    return record


def decode_text(path: Path, content: bytes) -> str:
    """Return the content of a file as a string.

    Raises:
        DamagedError: if the content is not text.
    """
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise DamagedError(f"cannot read {path}: it is damaged: {error}; {MEND}") from error
