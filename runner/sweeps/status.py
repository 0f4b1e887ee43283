"""Progress of a sweep, from its stored runs, its run times and the commands at work."""

import contextlib
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.base.errors import StoreError
from runner.base.machine import Machine
from runner.store.finished import Finished
from runner.store.seal import DamagedError, read_json
from runner.store.sweep import IncompleteError, Sweep
from runner.sweeps.at_work import Command, commands_at_work

NOTE = "progress.json"
_MEND = "a sweep at work writes it again"


@dataclass(frozen=True)
class Status:
    """Progress of a sweep.

    Attributes:
        done: Number of distinct stored runs, including failed ones.
        failed: Number of stored runs that failed.
        caveats: Number of caveats of each stored cell, in the order of the cells.
        left: Number of missing runs.
        missing: Cells whose run is missing, ascending.
        at_work: Commands that work on the sweep.
        seconds: Remaining time at the last recorded pace of the commands at work, in s; None if no pace is recorded.
        damage: Messages on damaged files, one for each file.
        machines: Number of stored runs of each machine.
    """

    done: int
    failed: int
    caveats: Sequence[int]
    left: int
    missing: Sequence[int]
    at_work: Sequence[Command]
    seconds: float | None
    damage: Sequence[str]
    machines: Mapping[Machine, int]


def find_status(sweep: Sweep) -> Status:
    """Return the progress of a sweep.

    Raises:
        OSError: if the outputs folder of the sweep cannot be read.
    """
    finished = Finished(sweep.outputs)
    names = set(sweep.hashes)
    ends = {name: finished.outcome(name) for name in names}
    stored = [end for end in ends.values() if end is not None]
    left = len(names) - len(stored)
    pace = None
    with contextlib.suppress(DamagedError):  # the sweep rewrites it every few seconds
        pace = read_pace(sweep.folder)
    at_work = commands_at_work(sweep.folder)
    return Status(
        done=len(stored),
        failed=sum(bool(end.failure) for end in stored),
        caveats=[end.caveats for name in sweep.hashes if (end := ends[name]) is not None],
        left=left,
        missing=[cell for cell, name in enumerate(sweep.hashes) if ends[name] is None],
        at_work=at_work,
        seconds=None if pace is None else pace * left / max(1, len(at_work)),
        damage=finished.damage,
        machines=Counter(end.machine for end in stored),
    )


@contextlib.contextmanager
def report_if_running(sweep: Sweep) -> Iterator[None]:
    """Raise that a sweep is running, instead of that it lacks runs, if a command works on it.

    Raises:
        StoreError: if the sweep lacks runs.
    """
    try:
        yield
    except IncompleteError as error:
        status = find_status(sweep)
        if not status.at_work:
            raise
        raise StoreError(
            f"{sweep.folder} is running, {status.done} of {status.done + status.left} cells are stored; "
            "wait, or watch it with: runner status"
        ) from error


def parts_of(cells: Sequence[int], parts: int) -> list[int]:
    """Return the numbers of the parts of a sweep that contain some of the given cells, ascending; see sweep.part."""
    return sorted({cell % parts for cell in cells})


def in_ranges(numbers: Sequence[int]) -> str:
    """Return ascending numbers as Slurm takes them for an array, such as "3,17,40-42"."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ",".join(f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs)


def read_pace(folder: Path) -> float | None:
    """Return the last time for a run that a sweep recorded, in s; None if there is none.

    Raises:
        DamagedError: if the record is damaged.
    """
    if not (folder / NOTE).exists():
        return None
    pace = read_json(folder / NOTE, _MEND).get("seconds_per_run")
    if not (isinstance(pace, float) and math.isfinite(pace)):
        raise DamagedError(f"cannot read {folder / NOTE}: it has no time for a run; {_MEND}")
    return pace
