"""Atomic file writes.

A reader sees the whole file, or no file.
"""

import contextlib
import os
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from runner.base.errors import StoreError, describe_write_error

_STALE = 60.0  # s; a temporary file lives for milliseconds


def write_atomically(path: Path, content: bytes, flush: bool = True) -> None:
    """Write a file through a temporary one in the same folder, which is made when missing.

    Args:
        path: The file.
        content: What it shall hold.
        flush: Whether it is on the disk on return; else a power cut may leave it empty, for its reader to find out.

    Raises:
        StoreError: if the folder or disk does not take it; what stood there before is untouched.
    """
    with open_atomically(path, flush) as file:
        file.write(content)


@contextlib.contextmanager
def open_atomically(path: Path, flush: bool = True) -> Iterator[BinaryIO]:
    """Open a file to write it part by part; see write_atomically. It is there once all is written without error.

    Raises:
        StoreError: if the folder or disk does not take it; what stood there before is untouched.
    """
    temporary = path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("wb") as file:
            yield file
            if flush:
                file.flush()
                os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        raise StoreError(describe_write_error(error, path)) from error
    finally:
        with contextlib.suppress(OSError):  # the first error says more
            temporary.unlink(missing_ok=True)


def remove_leftovers(folder: Path) -> None:
    """Remove temporary files of writers that were killed: whose process is gone, or that are older than a minute."""
    for path in folder.glob(".*.tmp"):
        host, _, process = path.name.removesuffix(".tmp").rpartition(".")
        with contextlib.suppress(OSError):
            here = host.endswith(f".{socket.gethostname()}")
            if (here and not _is_alive(process)) or time.time() - path.stat().st_mtime > _STALE:
                path.unlink()


def _is_alive(process: str) -> bool:
    """Tell whether a process may still write; one that ended and that its parent has not asked about may not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (OSError, IndexError):
        return False
    return state not in ("Z", "X")
