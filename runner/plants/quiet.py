"""Silence for C libraries that write to the process's outputs themselves."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def quiet_stderr() -> Iterator[None]:
    """Send file descriptor 2 to nowhere for a while; Python's own messages are flushed before."""
    with _quiet(2):
        yield


@contextmanager
def quiet_output() -> Iterator[None]:
    """Send file descriptors 1 and 2 to nowhere for a while; Python's own messages are flushed before."""
    with _quiet(1), _quiet(2):
        yield


@contextmanager
def _quiet(descriptor: int) -> Iterator[None]:
    sys.stdout.flush()
    sys.stderr.flush()
    saved = os.dup(descriptor)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, descriptor)
        yield
    finally:
        os.dup2(saved, descriptor)
        os.close(saved)
        os.close(nowhere)
