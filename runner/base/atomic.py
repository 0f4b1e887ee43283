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
    """Write a file through a temporary file in the same folder; create the folder if it is missing.

    Args:
        path: The file.
        content: Content of the file.
        flush: Whether the file is on the disk on return. Otherwise a power cut may leave it empty, and its reader must
            detect that.

    Raises:
        StoreError: if the file cannot be written; an existing file is untouched.
    """
    with open_atomically(path, flush) as file:
        file.write(content)


@contextlib.contextmanager
def open_atomically(path: Path, flush: bool = True) -> Iterator[BinaryIO]:
    """Open a file to write it part by part; see write_atomically. It appears after everything is written without error.

    Raises:
        StoreError: if the file cannot be written; an existing file is untouched.
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


def refuse_links(outputs: Path, path: Path) -> None:
    """Check that no part of a path in an outputs folder is a link: one in a stranger's folder may lead anywhere.

    Args:
        outputs: The outputs folder, which may itself be reached by a link.
        path: The file or folder that is written.

    Raises:
        StoreError: for a link.
    """
    for part in (path, *path.parents):
        if part == outputs:
            return
        if part.is_symlink():
            raise StoreError(
                f"{part}: it is a link, through which nothing is written. Remove it, or take another folder"
            )


def remove_leftovers(folder: Path) -> None:
    """Remove temporary files whose writing process is gone, and those older than a minute; none through a link."""
    for path in () if folder.is_symlink() else folder.glob(".*.tmp"):
        host, _, process = path.name.removesuffix(".tmp").rpartition(".")
        with contextlib.suppress(OSError):
            here = host.endswith(f".{socket.gethostname()}")
            if (here and not _is_alive(process)) or time.time() - path.stat().st_mtime > _STALE:
                path.unlink()


def _is_alive(process: str) -> bool:
    """Return True if a process may still write; an ended process that its parent has not reaped may not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (OSError, IndexError):
        return False
    return state not in ("Z", "X")
