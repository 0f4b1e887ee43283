"""Stored sweeps: the overrides and the hash of each run."""

import hashlib
import json
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from runner.base.atomic import refuse_links, write_atomically
from runner.base.errors import StoreError
from runner.store.axes import Axes, read_axes
from runner.store.finished import Finished
from runner.store.kinds import kind_of
from runner.store.names import Names
from runner.store.run import Run, open_run
from runner.store.seal import DamagedError, digest, head, read_file, read_json, seal_text

if TYPE_CHECKING:
    from runner.schema.bound import Bound
    from runner.statistics.spec import Histories

_FILE = "sweep.json"
_RUNS = "runs.bin"  # hashes of the runs of a grid, 12 bytes for each cell
QUESTION = "question.json"
"""File of a sweep with the axis that a user asked about."""
_AT_ONCE = 10_000  # rows
_REMEDY = "the sweep's command writes it again"
_NO_SPEC: "Mapping[str, Bound]" = {}


@dataclass(frozen=True, eq=False)
class Sweep:
    """A stored sweep, still running or ended.

    Attributes:
        folder: Folder of the sweep.
        overrides: Overrides of each job, in order.
        hashes: Hash of each job's run.
        command: Command that starts or resumes the sweep.
        spec: Bounds on metrics, against which the runs are evaluated instead of their own; empty for none.
        history: Bounds of all its commands, each with the date of the first command that had it.
        question: Axis that a user asked about last; empty for the one that its axes suggest.
    """

    folder: Path
    overrides: Sequence[Sequence[str]]
    hashes: Sequence[str]
    command: str
    spec: "Mapping[str, Bound]" = field(default_factory=dict)
    history: "Histories" = field(default_factory=dict)
    question: str = ""

    @property
    def continuation(self) -> str:
        """Command that continues the sweep; without the address of a scheduler, which may have ended."""
        return without_keys(self.command, ("hydra.sweeper.address",))

    @property
    def outputs(self) -> Path:
        """Outputs folder that contains the runs."""
        return self.folder.parent.parent

    def incomplete_text(self, left: int) -> str:
        """Return that some cells are not stored, with the command that continues.

        Args:
            left: Their number.
        """
        return f"{left} of {len(self.hashes)} cells of {self.folder} are not stored; continue with: {self.continuation}"

    def found(self) -> Iterator["tuple[int, Run] | InShard"]:
        """Yield the run of each cell: a cell with its run, or many cells with the shard that contains their runs.

        Raises:
            StoreError: if a run is missing or damaged.
        """
        finished, names = Finished(self.outputs), Names.of(self.hashes)
        places = finished.places_of(names)
        of_folder = finished.folders(names)
        places[[cell for cell, name in enumerate(names) if name in of_folder] if of_folder else []] = -1
        for cell in np.flatnonzero(places < 0).tolist():
            yield cell, self._open(finished, names[cell])
        shards = finished.shard[places] if len(finished.names) else places
        order = np.argsort(shards, kind="stable")
        order = order[places[order] >= 0]
        for cells in np.split(order, np.flatnonzero(np.diff(shards[order])) + 1) if len(order) else ():
            yield InShard(finished.shard_of(int(places[cells[0]])), finished.row[places[cells]], cells)

    def runs(self) -> Iterator[Run]:
        """Open the runs one after the other, in the order of the jobs.

        Raises:
            StoreError: if a run is missing or damaged.
        """
        finished = Finished(self.outputs)
        for name in self.hashes:
            yield self._open(finished, name)

    def _open(self, finished: Finished, name: str) -> Run:
        try:
            run = finished.open(name)
        except StoreError as error:
            left = sum(finished.outcome(each) is None for each in self.hashes) if type(error) is StoreError else 0
            if left and not finished.damage:
                raise IncompleteError(self.incomplete_text(left)) from error
            raise StoreError(f"{error}; `runner status {self.folder}` says what is left of the sweep") from error
        return run.judged_by(self.spec, self.history) if self.spec else run


class IncompleteError(StoreError):
    """A sweep lacks the runs of some cells."""


def without_keys(command: str, keys: Sequence[str]) -> str:
    """Return a command line without the overrides of some keys."""
    try:
        words = shlex.split(command)
    except ValueError:  # not the runner's
        return command
    kept = [word for word in words if word.partition("=")[0].lstrip("+") not in keys]
    return command if kept == words else shlex.join(kept)


@dataclass(frozen=True)
class InShard:
    """Cells of a sweep whose runs are in one shard.

    Attributes:
        path: File of the shard.
        rows: Row in the shard for each cell, shape (n,).
        cells: Numbers of the cells, ascending, shape (n,).
    """

    path: Path
    rows: NDArray[np.intp]
    cells: NDArray[np.intp]


def write_sweep(
    outputs: Path,
    jobs: Sequence[tuple[Sequence[str], str]],
    command: str,
    spec: "Mapping[str, Bound]" = _NO_SPEC,
    date: str = "",
) -> Path:
    """Store the overrides and the run of each job, and return the folder of the sweep.

    Args:
        outputs: The outputs folder.
        jobs: Overrides and hash of each run.
        command: Command that starts the sweep; not part of its name.
        spec: Bounds on metrics; not part of the name either.
        date: The date on which they are set; empty for today.

    Raises:
        StoreError: if a file cannot be written.
    """
    folder = outputs / "sweeps" / _name(_rows(jobs))
    write_jobs(folder, jobs, command, spec, date)
    return folder


def write_grid(outputs: Path, axes: Axes, names: Names, command: str, spec: "Mapping[str, Bound]" = _NO_SPEC) -> Path:
    """Store a sweep over a grid as its axes and a file with the names of the runs; return the folder of the sweep.

    Args:
        outputs: The outputs folder.
        axes: Swept keys and values.
        names: Hash of each cell's run.
        command: Command that starts the sweep; not part of its name.
        spec: Bounds on metrics; not part of the name either.

    Raises:
        StoreError: if a file cannot be written.
    """
    runs = names.packed()
    folder = outputs / "sweeps" / _name(_grid_rows(axes, digest(runs)))
    refuse_links(outputs, folder)
    write_atomically(folder / _RUNS, runs)
    content = {**_head(folder, command, spec), "axes": axes.content(), "cells": len(names), "runs": digest(runs)}
    write_atomically(folder / _FILE, seal_text(json.dumps(content, indent=1) + "\n"))
    return folder


def write_jobs(
    folder: Path,
    jobs: Sequence[tuple[Sequence[str], str]],
    command: str,
    spec: "Mapping[str, Bound]" = _NO_SPEC,
    date: str = "",
) -> None:
    """Store the overrides and the run of each job in a given folder, such as that of a tuning; see write_sweep."""
    refuse_links(folder.parent.parent, folder)
    start = json.dumps(_head(folder, command, spec, date))[:-1]
    write_atomically(folder / _FILE, seal_text(f'{start}, "jobs": [\n' + ",\n".join(_rows(jobs)) + "\n]}\n"))


def _head(folder: Path, command: str, spec: "Mapping[str, Bound]", date: str = "") -> dict[str, Any]:
    """Return the first entries of the file of a sweep; the history includes the bounds of the file that it replaces."""
    from runner.base.machine import today
    from runner.statistics.spec import merge_histories, settings

    try:
        known = read_json(folder / _FILE, _REMEDY).get("history", {})
    except DamagedError:
        known = {}
    told = {
        "spec": {metric: bound.model_dump() for metric, bound in spec.items()},
        "history": merge_histories(known, settings(spec, date or today())),
    }
    return {**head(), "command": command, **{key: value for key, value in told.items() if value}}


def _rows(jobs: Iterable[tuple[Sequence[str], str]]) -> Iterator[str]:
    return (json.dumps({"overrides": list(overrides), "run": name}) for overrides, name in jobs)


def _name(rows: Iterable[str]) -> str:
    """Return the name of a sweep's folder: a digest over the rows of its jobs, or over the rows of a grid."""
    found, left, between = hashlib.sha256(), iter(rows), ""
    while some := list(islice(left, _AT_ONCE)):
        found.update((between + "\n".join(some)).encode())
        between = "\n"
    return found.hexdigest()[:24]


def open_sweep(folder: Path) -> Sweep:
    """Open a stored sweep.

    Raises:
        StoreError: if the folder is not a sweep.
        DamagedError: if the sweep is damaged.
    """
    path = folder / _FILE
    if not path.exists():
        raise StoreError(
            f"{folder} is not a sweep: it has no {_FILE}; `runner -m OVERRIDES` makes one, and prints its folder"
        )
    content = read_json(path, _REMEDY)
    command = content.get("command", "")
    if not isinstance(command, str):
        raise DamagedError(f"cannot read {path}: its command is not a string; {_REMEDY}")
    read = _read_grid if "axes" in content else _read_jobs
    overrides, hashes, rows = read(path, content)
    place = folder.resolve()
    if place.parent.name == "sweeps" and _name(rows) != place.name:
        raise DamagedError(f"cannot read {path}: it is of another sweep than its folder is named after; {_REMEDY}")
    return Sweep(folder, overrides, hashes, command, *_read_spec(path, content), _read_question(folder))


def _read_question(folder: Path) -> str:
    path = folder / QUESTION
    return str(read_json(path, "`runner report SWEEP --by AXIS` writes it again")["axis"]) if path.exists() else ""


def _read_spec(path: Path, content: Mapping[str, Any]) -> "tuple[dict[str, Bound], Histories]":
    if not content.keys() & {"spec", "history"}:
        return {}, {}
    from runner.schema.bound import Bound
    from runner.statistics.spec import merge_histories

    try:
        bounds = {metric: Bound.model_validate(bound) for metric, bound in content.get("spec", {}).items()}
        return bounds, merge_histories(dict.fromkeys(bounds, ()), content.get("history", {}))
    except (AttributeError, TypeError, ValueError) as error:  # ValueError also covers pydantic
        raise DamagedError(f"cannot read {path}: its spec holds no bounds; {_REMEDY}") from error


def _read_jobs(path: Path, content: Mapping[str, Any]) -> tuple[Sequence[Sequence[str]], Sequence[str], Iterator[str]]:
    """Return overrides and hashes of jobs that are stored one by one, and the rows that name the sweep."""
    jobs = content.get("jobs")
    if not (isinstance(jobs, list) and all(map(_is_job, jobs))):
        raise DamagedError(
            f"cannot read {path}: it is not a sweep's: it needs jobs with overrides and run each; {_REMEDY}"
        )
    overrides, hashes = [tuple(job["overrides"]) for job in jobs], [job["run"] for job in jobs]
    return overrides, hashes, _rows(zip(overrides, hashes, strict=True))


def _read_grid(path: Path, content: Mapping[str, Any]) -> tuple[Sequence[Sequence[str]], Sequence[str], Iterator[str]]:
    """Return overrides and hashes of the cells of a grid, and the rows that name the sweep."""
    names = Names.unpacked(read_file(path.with_name(_RUNS), {_RUNS: str(content.get("runs"))}, _REMEDY))
    try:
        axes = read_axes(content["axes"])
    except StoreError as error:
        raise DamagedError(f"cannot read {path}: {error}; {_REMEDY}") from error
    if not len(axes) == len(names) == content.get("cells"):
        count = f"its axes have {len(axes)} cells, but there are {len(names)} runs"
        raise DamagedError(f"cannot read {path}: {count}; {_REMEDY}")
    return axes, names, _grid_rows(axes, str(content["runs"]))


def _grid_rows(axes: Axes, runs: str) -> Iterator[str]:
    """Return the rows that identify a grid: its axes, and the digest of the names of its runs."""
    return iter((json.dumps(axes.content()), runs))


def _is_job(job: object) -> bool:
    return (
        isinstance(job, dict)
        and isinstance(job.get("run"), str)
        and isinstance(job.get("overrides"), list)
        and all(isinstance(text, str) for text in job["overrides"])
    )


def open_runs(folder: Path) -> list[Run]:
    """Open the runs of a sweep's folder, or the run of a run's folder.

    Raises:
        StoreError: if the folder is neither, or is unfinished or damaged.
    """
    return (
        list(open_sweep(folder).runs()) if kind_of(folder) in ("sweep", "tuning", "challenge") else [open_run(folder)]
    )
