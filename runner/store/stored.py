"""What a run and a calibration have in common as they are stored."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from runner.errors import StoreError


@dataclass(frozen=True)
class Stored:
    """A job's folder, named by its content hash.

    Attributes:
        folder: The folder.
        config: Its resolved config.
        record: What came out, and where it comes from.
    """

    folder: Path
    config: Mapping[str, Any]
    record: Mapping[str, Any]

    @property
    def hash(self) -> str:
        """Its content hash, the folder's name."""
        return self.folder.name

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Commit, versions, machine, seed, command, warnings, and what more its kind of job tells."""
        provenance: Mapping[str, Any] = self.record["provenance"]
        return provenance

    @cached_property
    def urdf(self) -> str:
        """The URDF's text that was simulated.

        Raises:
            StoreError: if the file is missing or damaged.
        """
        path = self.folder / "robot.urdf"
        try:
            return path.read_text()
        except (OSError, UnicodeDecodeError) as error:
            raise StoreError(f"cannot read {path}: {error}; run it again to mend it") from error


def read_job(folder: Path, record: str, what: str) -> tuple[Any, Any]:
    """Return the contents of a job's record and config, unchecked.

    Args:
        folder: The job's folder.
        record: File name of the record.
        what: What the job is called, such as "run".

    Raises:
        StoreError: if one of the files is missing or damaged.
    """
    try:
        return (
            json.loads((folder / record).read_text()),
            yaml.load((folder / "config.yaml").read_text(), yaml.CSafeLoader),
        )
    except (OSError, UnicodeDecodeError, json.JSONDecodeError, yaml.YAMLError) as error:
        raise StoreError(f"cannot read the {what} in {folder}: {' '.join(str(error).split())}") from error
