"""Progress of a sweep, from its stored runs and noted times, and the lock of its outputs folder."""

import contextlib
import fcntl
import math
import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner import store
from runner.base.errors import RunnerError
from runner.store.seal import read_json

_PATIENCE = 1.0  # s; `runner status` holds the lock for an instant


@contextlib.contextmanager
def at_work(outputs: Path) -> Iterator[None]:
    """Keep other sweeps out of an outputs folder; the lock ends with the process, however that ends.

    Raises:
        RunnerError: if another sweep is at work there.
    """
    folder = os.open(outputs, os.O_RDONLY | os.O_DIRECTORY)
    try:
        deadline = time.monotonic() + _PATIENCE
        while not _lock(folder):
            if time.monotonic() > deadline:
                raise RunnerError(
                    f"another sweep is at work in {outputs}; wait for it (`runner status` tells how far it is), or "
                    "take another folder with outputs=FOLDER"
                )
            time.sleep(0.05)
        yield
    finally:
        os.close(folder)


def is_at_work(outputs: Path) -> bool:
    """Tell whether a sweep is at work in an outputs folder."""
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
        return True  # a file system without locks: two sweeps at once do some runs twice, and no harm
    return True


NOTE = "progress.json"
_MEND = "a sweep at work writes it again"


@dataclass(frozen=True)
class Status:
    """How far a sweep is.

    Attributes:
        done: Number of its distinct runs that are stored, failed ones included.
        failed: Number of stored runs that failed.
        caveats: Number of caveats of the run of each cell that is stored, in the order of the cells.
        left: Number of runs that are not stored.
        at_work: Whether a sweep is at work in its outputs folder.
        seconds: How long what is left will take at the last pace noted, in s; None where none is.
        damage: What is damaged of what is stored, a text for each file.
    """

    done: int
    failed: int
    caveats: Sequence[int]
    left: int
    at_work: bool
    seconds: float | None
    damage: Sequence[str]


def find_status(sweep: store.Sweep) -> Status:
    """Look how far a sweep is.

    Raises:
        OSError: if its outputs folder cannot be read.
    """
    finished = store.Finished(sweep.outputs)
    names = set(sweep.hashes)
    ends = {name: finished.outcome(name) for name in names}
    stored = [end for end in ends.values() if end is not None]
    left = len(names) - len(stored)
    pace = None
    with contextlib.suppress(store.DamagedError):  # it is written again every few seconds
        pace = read_pace(sweep.folder)
    return Status(
        done=len(stored),
        failed=sum(bool(end.failure) for end in stored),
        caveats=[end.caveats for name in sweep.hashes if (end := ends[name]) is not None],
        left=left,
        at_work=is_at_work(sweep.outputs),
        seconds=None if pace is None else pace * left,
        damage=finished.damage,
    )


def read_pace(folder: Path) -> float | None:
    """Return the time for a run that a sweep noted last, in s; None where it noted none.

    Raises:
        DamagedError: if the note is damaged.
    """
    if not (folder / NOTE).exists():
        return None
    pace = read_json(folder / NOTE, _MEND).get("seconds_per_run")
    if not (isinstance(pace, float) and math.isfinite(pace)):
        raise store.DamagedError(f"cannot read {folder / NOTE}: it holds no time of a run; {_MEND}")
    return pace
