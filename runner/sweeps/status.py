"""How far a sweep is: told from what is stored, and the times noted while it runs."""

import json
from dataclasses import dataclass
from pathlib import Path

from runner import store
from runner.sweeps.lock import is_at_work

NOTE = "progress.json"


@dataclass(frozen=True)
class Status:
    """How far a sweep is.

    Attributes:
        done: Number of its distinct runs that are stored, failed ones included.
        failed: Number of stored runs that failed.
        left: Number of runs that are not stored.
        at_work: Whether a sweep is at work in its outputs folder.
        seconds: How long what is left will take at the last pace noted, in s; None where none is.
    """

    done: int
    failed: int
    left: int
    at_work: bool
    seconds: float | None


def find_status(sweep: store.Sweep) -> Status:
    """Look how far a sweep is.

    Raises:
        StoreError: if a shard of its outputs folder cannot be read.
    """
    shards = store.Shards(sweep.outputs)
    names = set(sweep.hashes)
    ends = [store.find_outcome(sweep.outputs, name) or shards.outcome(name) for name in names]
    stored = [end for end in ends if end is not None]
    left = len(names) - len(stored)
    pace = _read_pace(sweep.folder)
    return Status(
        done=len(stored),
        failed=sum(bool(end.failure) for end in stored),
        left=left,
        at_work=is_at_work(sweep.outputs),
        seconds=None if pace is None else pace * left,
    )


def _read_pace(folder: Path) -> float | None:
    try:
        return float(json.loads((folder / NOTE).read_text())["seconds_per_run"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def in_words(seconds: float) -> str:
    """Return a duration as a person would say it."""
    if seconds < 90.0:
        return f"{max(1, round(seconds))} s"
    if seconds < 5400.0:
        return f"{round(seconds / 60.0)} min"
    return f"{seconds / 3600.0:.1f} h"
