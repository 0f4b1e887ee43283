"""Common base of stored runs and calibrations."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from runner.base.bounded_yaml import STORED, YamlError, read_yaml
from runner.base.cache import Memory
from runner.store.atomic import write_atomically
from runner.store.seal import SCHEMA, DamagedError, digest, read_file, read_json, sealed_json

MEND = "run it again to repair it"
_NAMED = ("runs", "calibrations")  # parents of folders that have the name of their job; a copy may have any name
# Keys for the location, name and report of a run. They do not affect the simulation.
_LEFT_OUT = ("caveats", "limits", "outputs", "preset", "spec", "sweep")
_TRAJECTORIES = Memory(256)
_UNUSUAL = re.compile(r"[&?]|\[(?!\])|\{(?!\})|^ {60}|(- ){4}", re.M)


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
    try:  # the runner writes no aliases or braces, and only these can exceed the bounds; the bounds take time
        ours = len(text) <= STORED.size.most and not _UNUSUAL.search(text)
        config = yaml.load(text, yaml.CSafeLoader) if ours else read_yaml(text, path)
    except (yaml.YAMLError, YamlError) as error:
        raise DamagedError(f"cannot read {path}: it is damaged: {' '.join(str(error).split())}; {MEND}") from error
    if not isinstance(config, dict):
        raise DamagedError(f"cannot read {path}: it is damaged: it holds no config; {MEND}")
    return record, config


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
