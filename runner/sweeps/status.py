"""Progress of a sweep, from its stored runs and run times, and the lock of its outputs folder."""

import contextlib
import fcntl
import math
import os
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.base.errors import RunnerError
from runner.base.machine import Machine
from runner.store.finished import Finished
from runner.store.seal import DamagedError, read_json
from runner.store.sweep import Sweep

_PATIENCE = 1.0  # s; `runner status` holds the lock for an instant


@contextlib.contextmanager
def at_work(outputs: Path) -> Iterator[None]:
    """Lock an outputs folder against other sweeps; the lock ends with the process, even if that is killed.

    Raises:
        RunnerError: if another sweep uses the folder.
    """
    folder = os.open(outputs, os.O_RDONLY | os.O_DIRECTORY)
    try:
        deadline = time.monotonic() + _PATIENCE
        while not _lock(folder):
            if time.monotonic() > deadline:
                raise RunnerError(
                    f"another sweep is at work in {outputs}; wait for it (`runner status` shows its progress), or "
                    "choose another folder with outputs=FOLDER"
                )
            time.sleep(0.05)
        yield
    finally:
        os.close(folder)


def is_at_work(outputs: Path) -> bool:
    """Return True if a sweep is running in an outputs folder."""
    folder = os.open(outputs, os.O_RDONLY | os.O_DIRECTORY)
    try:
        return not _lock(folder)
    finally:
        os.close(folder)


def _lock(folder: int) -> bool:
    try:
        fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True  # no file locks: two simultaneous sweeps repeat some runs, which is harmless
    return True


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
        at_work: True if a sweep is running in the outputs folder.
        seconds: Remaining time at the last recorded pace, in s; None if no pace is recorded.
        damage: Messages on damaged files, one for each file.
        machines: Number of stored runs of each machine.
    """

    done: int
    failed: int
    caveats: Sequence[int]
    left: int
    at_work: bool
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
    return Status(
        done=len(stored),
        failed=sum(bool(end.failure) for end in stored),
        caveats=[end.caveats for name in sweep.hashes if (end := ends[name]) is not None],
        left=left,
        at_work=is_at_work(sweep.outputs),
        seconds=None if pace is None else pace * left,
        damage=finished.damage,
        machines=Counter(end.machine for end in stored),
    )


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
