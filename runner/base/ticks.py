"""Counter of simulated ticks in this process, without overhead for each tick."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

_EVERY = 1.0  # s between two reports of the count


class _Count:
    """Ticks of finished repetitions, and the clock of the current one: start time of each row, 0 before its start."""

    def __init__(self) -> None:
        self.ended = 0
        self.clock: NDArray[np.int64] | None = None


_count = _Count()
_adding = threading.Lock()


@contextmanager
def track_ticks(clock: NDArray[np.int64], ticks: int) -> Iterator[None]:
    """Count the ticks of a running repetition by its clock: start time of each row in ns, 0 before its start."""
    _count.clock = clock
    try:
        yield
    finally:
        _count.clock = None
        _count.ended += ticks


def add_ticks(ticks: int) -> None:
    """Count ticks that were simulated together, in any thread."""
    with _adding:
        _count.ended += ticks


def completed_ticks() -> int:
    """Return the number of ticks so far, from any thread."""
    clock = _count.clock
    return _count.ended + (0 if clock is None else int(np.count_nonzero(clock)))


def counter() -> Callable[[], int]:
    """Return a function that returns the number of ticks simulated since now, from any thread."""
    before = completed_ticks()
    return lambda: completed_ticks() - before


@contextmanager
def report_ticks(tell: Callable[[int], None] | None) -> Iterator[None]:
    """Report the number of ticks simulated within the context each second, from a thread; do nothing for None."""
    if tell is None:
        yield
        return
    count, ended = counter(), threading.Event()

    def watch() -> None:
        while not ended.wait(_EVERY):
            tell(count())

    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
