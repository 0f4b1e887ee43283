"""The end of patience: a run that takes longer than its time limit is interrupted, wherever it is."""

import contextlib
import ctypes
import os
import threading
from collections.abc import Iterator

STUCK = 10.0  # s after the limit, until a worker process that cannot be interrupted is ended


class TimeLimitError(BaseException):
    """A run that took longer than its time limit; no Exception, so that no part of the user's catches it by chance."""


@contextlib.contextmanager
def deadline(seconds: float | None) -> Iterator[None]:
    """Raise TimeLimitError in what is done within, once it takes longer than some seconds; None for no limit.

    Python code is interrupted at its next line; a call into compiled code when it returns. A worker process in which
    that does not happen is ended, which its sweep survives.
    """
    if seconds is None:
        yield
        return
    thread, ended, guard = threading.current_thread(), threading.Event(), threading.Lock()

    def watch() -> None:
        if ended.wait(seconds):
            return
        with guard:
            if not ended.is_set():
                error = ctypes.py_object(TimeLimitError)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0), error)
        if not ended.wait(STUCK) and thread is not threading.main_thread():
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        with guard:
            ended.set()
