"""Writing files so that a reader sees them whole or not at all."""

import contextlib
import os
from pathlib import Path

from runner.errors import StoreError


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file through a temporary one in the same folder, which is made when missing.

    Raises:
        StoreError: if the folder or disk does not take it; what stood there before is untouched.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):  # the first error says more
            temporary.unlink(missing_ok=True)
        raise StoreError(f"cannot write {path}: {error.strerror}") from error
