"""Entry points of installed packages in the groups `runner.GROUP`, for a tenth of the time of importlib.metadata.

It reads the metadata of every package; here only files of entry points in the folders of `sys.path` are read. Python's
own way serves where a finder of another kind is at work.
"""

import os
import sys
from collections.abc import Iterator, Sequence
from functools import lru_cache
from importlib.machinery import PathFinder
from pathlib import Path
from typing import NamedTuple

_PREFIX = "runner."


class EntryPoint(NamedTuple):
    """A part of a package, as importlib.metadata describes it.

    Attributes:
        name: Name of the part.
        value: Its module, and after a colon its function if it is one.
        group: Such as "runner.controller".
    """

    name: str
    value: str
    group: str

    @property
    def module(self) -> str:
        """The module."""
        return self.value.partition("[")[0].partition(":")[0].strip()

    @property
    def attr(self) -> str:
        """The function; empty if the part is a module."""
        return self.value.partition("[")[0].partition(":")[2].strip()


def entry_points_of(group: str) -> Sequence[EntryPoint]:
    """Return the entry points of a group, such as "controller"; cached by `sys.path`."""
    path, name = tuple(sys.path), f"{_PREFIX}{group}"
    if any(hasattr(finder, "find_distributions") for finder in sys.meta_path if finder is not PathFinder):
        return _known_to_python(path, name)
    return [point for point in _in_folders(path) if point.group == name]


@lru_cache(maxsize=64)
def _known_to_python(_path: tuple[str, ...], group: str) -> Sequence[EntryPoint]:
    from importlib.metadata import entry_points  # slow, which completion of words does without

    return tuple(EntryPoint(point.name, point.value, point.group) for point in entry_points(group=group))


@lru_cache(maxsize=16)
def _in_folders(path: tuple[str, ...]) -> Sequence[EntryPoint]:
    files: dict[str, Path] = {}
    for folder in path:
        for name, file in _packages(Path(folder or ".")):
            files.setdefault(name, file)  # the first one of a name counts
    return [point for file in files.values() for point in _read(file)]


def _packages(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield name and file of entry points of each package in a folder of `sys.path`; the file may not exist."""
    try:
        entries = sorted(entry.name for entry in os.scandir(folder))
    except OSError:
        return
    for entry in entries:
        stem, dot, kind = entry.rpartition(".")
        if dot and kind in ("dist-info", "egg-info"):
            yield stem.partition("-")[0].lower().replace("-", "_"), folder / entry / "entry_points.txt"


def _read(file: Path) -> Iterator[EntryPoint]:
    """Yield the entry points in a file that belong to the runner."""
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return
    group = ""
    for line in map(str.strip, lines):
        if line.startswith("["):
            group = line.strip("[]")
        elif group.startswith(_PREFIX) and "=" in line and line[0] not in "#;":
            name, _, value = line.partition("=")
            yield EntryPoint(name.strip(), value.strip(), group)
