"""Disk cache of compiled code and small answers in the user's cache folder, with permission checks.

Other users must not be able to write to the folder, because the machine code in it is loaded as it is.
"""

import functools
import hashlib
import json
import os
import stat
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

_LARGEST = 64 * 2**20  # bytes of one file
_MOST_ANSWERS = 1000
_ANSWER = "answer-"  # begins the name of each


def folder() -> Path | None:
    """Return the folder of compiled code, made where it is missing; None where it cannot be trusted; that is told.

    It is `arm-control-runner/compiled` within XDG_CACHE_HOME or ~/.cache, open to the user alone. It is not used where
    it, or a folder that leads to it, belongs to somebody else than the user or root, or can be written by others.
    """
    base = os.environ.get("XDG_CACHE_HOME")
    try:
        place = (Path(base) if base else Path.home() / ".cache") / "arm-control-runner" / "compiled"
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        place = place.resolve(strict=True)
        own, others = {os.getuid()}, {0, os.getuid()}
        if _is_safe(place, own, 0) and all(_is_safe(path, others, stat.S_ISVTX) for path in place.parents):
            return place
    except (OSError, RuntimeError):
        return None
    _tell(f"runner: compiled code is not kept: {place}, or a folder above it, can be changed by other users")
    return None


@functools.lru_cache(maxsize=4)
def _tell(text: str) -> None:
    print(text, file=sys.stderr)


def _is_safe(path: Path, owners: set[int], allowed: int) -> bool:
    """Tell whether only these owners can change what a folder holds, or whether it has an allowed bit.

    In a sticky folder, as /tmp is, nobody can rename what belongs to another.
    """
    status = path.stat()
    others = status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return status.st_uid in owners and bool(not others or status.st_mode & allowed)


def read(key: str) -> tuple[bytes, dict[str, Any]] | None:
    """Return the code of a key and what is kept with it; None where there is none, or it is damaged."""
    place = folder()
    if place is None:
        return None
    try:
        with (place / key).open("rb") as file:
            status = os.fstat(file.fileno())
            others = status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
            if status.st_uid != os.getuid() or others or status.st_size > _LARGEST:
                return None
            header = json.loads(file.readline(2**16))
            code = file.read()
        about, digest = header["about"], header["sha256"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    if not isinstance(about, dict) or _digest(key, code, about) != digest:
        return None
    return code, about


def write(key: str, code: bytes, about: Mapping[str, Any]) -> None:
    """Keep the code of a key, and plain data on it; where that fails it is compiled again the next time."""
    place = folder()
    if place is None:
        return
    header = json.dumps({"about": about, "sha256": _digest(key, code, about)})
    try:
        with tempfile.NamedTemporaryFile(dir=place, delete=False) as file:
            file.write(header.encode() + b"\n" + code)
        Path(file.name).replace(place / key)
    except OSError:
        return


def read_answer(key: str) -> Any:
    """Return the plain data kept under a key; None if there is none."""
    found = read(f"{_ANSWER}{key}")
    return None if found is None else json.loads(found[0])


def write_answer(key: str, answer: Any) -> None:
    """Keep plain data under a key; if that fails it is computed again the next time."""
    place = folder()
    kept = [] if place is None else list(place.glob(f"{_ANSWER}*"))
    for path in kept if len(kept) >= _MOST_ANSWERS else ():
        path.unlink(missing_ok=True)
    write(f"{_ANSWER}{key}", json.dumps(answer).encode(), {})


def _digest(key: str, code: bytes, about: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps([key, about]).encode() + b"\0" + code).hexdigest()
