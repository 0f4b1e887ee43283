"""Time limit of a run, enforced by an interruption."""

import contextlib
import ctypes
import os
import threading
from collections.abc import Callable, Iterator

STUCK = 10.0  # s after the limit, until a worker process that cannot be interrupted is ended


class TimeLimitError(BaseException):
    """Run that took longer than its time limit.

    It is not an Exception, so that a plug-in does not catch it by chance.
    """


@contextlib.contextmanager
def deadline(
    seconds: float | None, wait: Callable[[threading.Event, float], bool] = threading.Event.wait
) -> Iterator[None]:
    """Raise TimeLimitError in the body once it takes longer than a time limit.

    Python code is interrupted at its next line, and a call into compiled code when it returns. A worker process that
    cannot be interrupted is ended; its sweep continues.

    Args:
        seconds: The limit [s]; None for no limit.
        wait: Function that waits for an event for at most a time [s] and returns True if the event happened.
    """
    if seconds is None:
        yield
        return
    thread, ended, guard = threading.current_thread(), threading.Event(), threading.Lock()

    def watch() -> None:
        if wait(ended, seconds):
            return
        with guard:
            if not ended.is_set():
                error = ctypes.py_object(TimeLimitError)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0), error)
        if not wait(ended, STUCK) and thread is not threading.main_thread():
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        with guard:
            ended.set()
