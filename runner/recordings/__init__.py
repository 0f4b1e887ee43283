"""Recordings of real arms: reading, time alignment, comparison with stored runs, and friction identification."""

import hashlib
from pathlib import Path

_BLOCK = 1_000_000  # bytes held at a time


def digest_of(path: Path) -> str:
    """Return the SHA-256 of the file of a recording, or of all files in its folder, one after another."""
    found = hashlib.sha256()
    for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
        if file.is_file():
            with file.open("rb") as opened:
                while block := opened.read(_BLOCK):
                    found.update(block)
    return found.hexdigest()
