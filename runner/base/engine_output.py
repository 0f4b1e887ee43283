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
    """Discard output to file descriptor 2 within the context; Python's own output is flushed before."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        with _sent_to(nowhere, 2):
            yield
    finally:
        os.close(nowhere)


@contextmanager
def caught_output(descriptor: int, engines: str = "") -> Iterator[list[str]]:
    """Capture the output of an engine to a file descriptor within the context.

    Args:
        descriptor: 1 or 2.
        engines: Pattern at the start of the engine's lines; other lines, such as logs of other threads, are passed on.

    Yields:
        List that contains the distinct lines of the engine after the end of the context.
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
    """Flush the buffers of Python and C, so that their content goes to its original target."""
    sys.stdout.flush()
    sys.stderr.flush()
    _C.fflush(None)
