"""Stored sweeps: which overrides led to which run."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.errors import StoreError
from runner.store.atomic import write_atomically
from runner.store.run import Run, open_run
from runner.store.shards import Shards


@dataclass(frozen=True)
class Sweep:
    """A stored sweep, at work or ended.

    Attributes:
        folder: Its folder.
        overrides: Overrides of each job, in order.
        hashes: Hash of each job's run.
        command: The command that makes it and goes on with it.
    """

    folder: Path
    overrides: Sequence[Sequence[str]]
    hashes: Sequence[str]
    command: str

    @property
    def outputs(self) -> Path:
        """The outputs folder that holds its runs."""
        return self.folder.parent.parent

    def runs(self) -> Iterator[Run]:
        """Open its runs, one after the other, in the order of the jobs.

        Raises:
            StoreError: if one is missing or damaged.
        """
        shards = Shards(self.outputs)
        for name in self.hashes:
            folder = self.outputs / "runs" / name
            kept = None if (folder / "metrics.json").exists() else shards.open(name)
            try:
                yield kept or open_run(folder)
            except StoreError as error:
                raise StoreError(f"{error}; `runner status {self.folder}` says what is left of the sweep") from error


def write_sweep(outputs: Path, jobs: Sequence[tuple[Sequence[str], str]], command: str) -> Path:
    """Store which overrides lead to which run, and return the sweep's folder.

    Args:
        outputs: The outputs folder.
        jobs: Overrides and hash of each run.
        command: The command that makes the sweep; no part of its name.

    Raises:
        StoreError: if the disk does not take it.
    """
    rows = [json.dumps({"overrides": list(overrides), "run": name}) for overrides, name in jobs]
    folder = outputs / "sweeps" / hashlib.sha256("\n".join(rows).encode()).hexdigest()[:24]
    text = f'{{"schema": 1, "command": {json.dumps(command)}, "jobs": [\n' + ",\n".join(rows) + "\n]}\n"
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
        content = json.loads(path.read_text())
        jobs = content["jobs"]
        overrides, hashes = [tuple(job["overrides"]) for job in jobs], [str(job["run"]) for job in jobs]
        return Sweep(folder, overrides, hashes, str(content.get("command", "")))
    except (KeyError, TypeError) as error:
        raise StoreError(f"{path} is no sweep file: it needs jobs with overrides and run each") from error
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise StoreError(f"cannot read the sweep in {folder}: {error}") from error


def open_runs(folder: Path) -> list[Run]:
    """Open what a folder holds: the runs of a sweep, or one run.

    Raises:
        StoreError: if it is neither, unfinished or damaged.
    """
    return list(open_sweep(folder).runs()) if is_sweep(folder) else [open_run(folder)]
