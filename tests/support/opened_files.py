"""Files and folders that this process opens while a test watches, by an audit hook of Python."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_EVENTS = ("open", "os.listdir", "os.scandir")
_watchers: list[set[str]] = []
_hooked: list[bool] = []  # a hook cannot be taken out again


@contextmanager
def opened() -> Iterator[set[str]]:
    """Yield a set that collects the real path of each file opened within the block."""
    if not _hooked:
        _hooked.append(True)
        sys.addaudithook(_note)
    seen: set[str] = set()
    _watchers.append(seen)
    try:
        yield seen
    finally:
        _watchers.remove(seen)


def outside(seen: set[str], *folders: str | Path) -> set[str]:
    """Return the paths that are in none of some folders."""
    allowed = [os.path.realpath(folder) for folder in folders]
    return {path for path in seen if not any(Path(path).is_relative_to(folder) for folder in allowed)}


def _note(event: str, given: tuple[object, ...]) -> None:
    if _watchers and event in _EVENTS and isinstance(given[0], str | bytes | os.PathLike):
        for seen in _watchers:
            seen.add(os.path.realpath(os.fsdecode(given[0])))
