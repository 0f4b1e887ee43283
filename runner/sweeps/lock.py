"""Lock of an outputs folder, for one sweep at a time."""

import contextlib
import fcntl
import os
import time
from collections.abc import Iterator
from pathlib import Path

from runner.base.errors import RunnerError

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
