"""Stored sweeps: which overrides led to which run."""

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.errors import StoreError
from runner.store.atomic import write_atomically
from runner.store.finished import Finished
from runner.store.run import Run, open_run
from runner.store.seal import DamagedError, head, is_sealed, read_json, sealed

_FILE = "sweep.json"
_MEND = "the sweep's command writes it again"


@dataclass(frozen=True)
class Sweep:
    """A stored sweep, at work or ended.

    Attributes:
        folder: Its folder.
        overrides: Overrides of each job, in order.
        hashes: Hash of each job's run.
        command: The command that makes it and goes on with it.
        sealed: Whether its file has a digest; one of schema 1 has none.
    """

    folder: Path
    overrides: Sequence[Sequence[str]]
    hashes: Sequence[str]
    command: str
    sealed: bool = True

    @property
    def outputs(self) -> Path:
        """The outputs folder that holds its runs."""
        return self.folder.parent.parent

    def runs(self) -> Iterator[Run]:
        """Open its runs, one after the other, in the order of the jobs.

        Raises:
            StoreError: if one is missing or damaged.
        """
        finished = Finished(self.outputs)
        for name in self.hashes:
            try:
                yield finished.open(name)
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
    rows = _rows(jobs)
    folder = outputs / "sweeps" / _name(rows)
    write_atomically(folder / _FILE, _sealed_sweep(rows, command))
    return folder


def write_jobs(folder: Path, jobs: Sequence[tuple[Sequence[str], str]], command: str) -> None:
    """Store which overrides lead to which run in a folder of another kind, such as a tuning's: see write_sweep."""
    write_atomically(folder / _FILE, _sealed_sweep(_rows(jobs), command))


def _sealed_sweep(rows: Sequence[str], command: str) -> bytes:
    start = json.dumps({**head(), "command": command})[:-1]
    return sealed(f'{start}, "jobs": [\n' + ",\n".join(rows) + "\n]}\n")


def _rows(jobs: Iterable[tuple[Sequence[str], str]]) -> list[str]:
    return [json.dumps({"overrides": list(overrides), "run": name}) for overrides, name in jobs]


def _name(rows: Sequence[str]) -> str:
    return hashlib.sha256("\n".join(rows).encode()).hexdigest()[:24]


def is_sweep(folder: Path) -> bool:
    """Tell whether a folder is a sweep's."""
    return (folder / _FILE).exists()


def open_sweep(folder: Path) -> Sweep:
    """Open a stored sweep.

    Raises:
        StoreError: if the folder is no sweep.
        DamagedError: if it is damaged.
    """
    path = folder / _FILE
    if not path.exists():
        raise StoreError(
            f"{folder} is no sweep: it has no {_FILE}; `runner -m OVERRIDES` makes one, and prints its folder"
        )
    content = read_json(path, _MEND)
    jobs = content.get("jobs")
    if not (isinstance(jobs, list) and all(map(_is_job, jobs)) and isinstance(content.get("command", ""), str)):
        raise DamagedError(f"cannot read {path}: it is no sweep's: it needs jobs with overrides and run each; {_MEND}")
    overrides, hashes = [tuple(job["overrides"]) for job in jobs], [job["run"] for job in jobs]
    place = folder.resolve()
    if place.parent.name == "sweeps" and _name(_rows(zip(overrides, hashes, strict=True))) != place.name:
        raise DamagedError(f"cannot read {path}: it is of another sweep than its folder is named after; {_MEND}")
    return Sweep(folder, overrides, hashes, content.get("command", ""), is_sealed(content))


def _is_job(job: object) -> bool:
    return (
        isinstance(job, dict)
        and isinstance(job.get("run"), str)
        and isinstance(job.get("overrides"), list)
        and all(isinstance(text, str) for text in job["overrides"])
    )


def open_runs(folder: Path) -> list[Run]:
    """Open what a folder holds: the runs of a sweep, or one run.

    Raises:
        StoreError: if it is neither, unfinished or damaged.
    """
    return list(open_sweep(folder).runs()) if is_sweep(folder) else [open_run(folder)]
