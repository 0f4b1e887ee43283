"""Stored sweeps: which overrides led to which run."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.errors import StoreError
from runner.store.atomic import write_atomically
from runner.store.run import Run, open_run


@dataclass(frozen=True)
class Sweep:
    """A stored sweep.

    Attributes:
        folder: Its folder.
        overrides: Overrides of each job, in order.
        hashes: Hash of each job's run.
    """

    folder: Path
    overrides: Sequence[Sequence[str]]
    hashes: Sequence[str]

    def runs(self) -> list[Run]:
        """Open its runs.

        Raises:
            StoreError: if one is missing or damaged.
        """
        return [open_run(self.folder.parent.parent / "runs" / name) for name in self.hashes]


def write_sweep(outputs: Path, jobs: Sequence[tuple[Sequence[str], str]]) -> Path:
    """Store which overrides led to which run, and return the sweep's folder."""
    content = {"schema": 1, "jobs": [{"overrides": list(overrides), "run": name} for overrides, name in jobs]}
    text = json.dumps(content, indent=1) + "\n"
    folder = outputs / "sweeps" / hashlib.sha256(text.encode()).hexdigest()[:24]
    write_atomically(folder / "sweep.json", text.encode())
    return folder


def is_sweep(folder: Path) -> bool:
    """Tell whether a folder is a sweep's."""
    return (folder / "sweep.json").exists()


def open_sweep(folder: Path) -> Sweep:
    """Open a stored sweep.

    Raises:
        StoreError: if the folder is no sweep or damaged.
    """
    path = folder / "sweep.json"
    try:
        jobs = json.loads(path.read_text())["jobs"]
        return Sweep(folder, [tuple(job["overrides"]) for job in jobs], [str(job["run"]) for job in jobs])
    except (KeyError, TypeError) as error:
        raise StoreError(f"{path} is no sweep file: it needs jobs with overrides and run each") from error
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise StoreError(f"cannot read the sweep in {folder}: {error}") from error


def open_runs(folder: Path) -> list[Run]:
    """Open what a folder holds: the runs of a sweep, or one run.

    Raises:
        StoreError: if it is neither, unfinished or damaged.
    """
    return open_sweep(folder).runs() if is_sweep(folder) else [open_run(folder)]
