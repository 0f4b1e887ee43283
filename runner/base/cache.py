"""Disk cache of compiled code and small answers in the user's cache folder, with permission checks.

Other users must not be able to write to the folder, because its machine code is loaded and executed.
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

from runner.base.bounded_json import decode_json

_LARGEST = 64 * 2**20  # bytes, limit of one file
_MOST_ANSWERS = 1000
_ANSWER = "answer-"  # prefix of file names


def folder() -> Path | None:
    """Return the folder of compiled code, created if missing; None if that fails or, after a message, if unsafe.

    It is `arm-control-runner/compiled` in XDG_CACHE_HOME or ~/.cache, with access only for the user. It is not used if
    it belongs to another user, a folder above it belongs to another user than root, or others can write to one of them.
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
    """Return True if a folder has one of these owners, and others cannot write to it or an allowed mode bit is set.

    In a sticky folder such as /tmp, users cannot rename files of other users.
    """
    status = path.stat()
    others = status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return status.st_uid in owners and bool(not others or status.st_mode & allowed)


def read(key: str) -> tuple[bytes, dict[str, Any]] | None:
    """Return the code of a key and its metadata; None if it is missing or damaged."""
    place = folder()
    if place is None:
        return None
    try:
        with (place / key).open("rb") as file:
            status = os.fstat(file.fileno())
            others = status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
            if status.st_uid != os.getuid() or others or status.st_size > _LARGEST:
                return None
            header = decode_json(file.readline(2**16))
            code = file.read()
        about, digest = header["about"], header["sha256"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    if not isinstance(about, dict) or _digest(key, code, about) != digest:
        return None
    return code, about


def write(key: str, code: bytes, about: Mapping[str, Any]) -> None:
    """Store the code of a key, with metadata; if that fails, the code is compiled again the next time."""
    place = folder()
    if place is None:
        return
    header = json.dumps({"about": about, "sha256": _digest(key, code, about)})
    try:
        descriptor, temporary = tempfile.mkstemp(dir=place)
        try:
            with open(descriptor, "wb") as file:  # noqa: PTH123 - a descriptor
                file.write(header.encode() + b"\n" + code)
            Path(temporary).replace(place / key)
        finally:
            Path(temporary).unlink(missing_ok=True)
    except OSError:
        return


def read_answer(key: str) -> Any:
    """Return the plain data stored under a key; None if there is none."""
    found = read(f"{_ANSWER}{key}")
    return None if found is None else decode_json(found[0])


def write_answer(key: str, answer: Any) -> None:
    """Store plain data under a key; if that fails, it is computed again the next time."""
    place = folder()
    kept = [] if place is None else list(place.glob(f"{_ANSWER}*"))
    for path in kept if len(kept) >= _MOST_ANSWERS else ():
        path.unlink(missing_ok=True)
    write(f"{_ANSWER}{key}", json.dumps(answer).encode(), {})


def _digest(key: str, code: bytes, about: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps([key, about]).encode() + b"\0" + code).hexdigest()
