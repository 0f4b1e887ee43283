"""Suppression and capture of output that C libraries write to stdout and stderr."""

import ctypes
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

_C = ctypes.CDLL(None)


@contextmanager
def quiet_stderr() -> Iterator[None]:
    """Send file descriptor 2 to nowhere for a while; Python's own messages are flushed before."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        with _sent_to(nowhere, 2):
            yield
    finally:
        os.close(nowhere)


@contextmanager
def caught_output(descriptor: int, engines: str = "") -> Iterator[list[str]]:
    """Catch what an engine writes to a file descriptor for a while.

    Args:
        descriptor: 1 or 2.
        engines: Pattern that the engine's lines begin with; others, such as what another thread logs, are written on.

    Yields:
        The engine's lines, each once, there when the block has ended.
    """
    said: list[str] = []
    with tempfile.TemporaryFile() as file:
        try:
            with _sent_to(file.fileno(), descriptor):
                yield said
        finally:
            file.seek(0)
            lines = file.read().decode(errors="replace").splitlines()
            said += dict.fromkeys(line.strip() for line in lines if line.strip() and re.match(engines, line))
            others = "".join(f"{line}\n" for line in lines if not re.match(engines, line))
            if others:
                os.write(descriptor, others.encode())


@contextmanager
def _sent_to(target: int, descriptor: int) -> Iterator[None]:
    _flush()
    saved = os.dup(descriptor)
    try:
        os.dup2(target, descriptor)
        yield
    finally:
        _flush()
        os.dup2(saved, descriptor)
        os.close(saved)


def _flush() -> None:
    """Write out what Python and C still hold back, so that it goes where it was meant to."""
    sys.stdout.flush()
    sys.stderr.flush()
    _C.fflush(None)
