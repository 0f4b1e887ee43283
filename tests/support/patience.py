"""Time limit of a test for expected events: it ends hangs and measures nothing."""

from collections.abc import Callable
from threading import Event

PATIENCE = 300.0  # s


def wait_until(happened: Callable[[], object], patience: float = PATIENCE) -> None:
    """Look again and again until something has happened.

    Raises:
        TimeoutError: if it has not within the patience.
    """
    pause = Event()
    for _ in range(int(patience / _BETWEEN)):
        if happened():
            return
        pause.wait(_BETWEEN)
    raise TimeoutError(f"{happened} did not happen within {patience} s")


_BETWEEN = 0.02  # s between two looks
