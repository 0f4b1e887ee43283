"""Completion of paths and of stored folders in ./outputs."""

import os
from collections.abc import Iterator, Sequence

from runner.store.latest import WORD, Kind, folder_of

_FEW = 50


def stored_folders(word: str, kinds: Sequence[Kind]) -> Iterator[str]:
    """Yield the folders in ./outputs that hold some kinds of things, and the word `latest`.

    Of many, the folder that they lie in stands for them until it is typed.
    """
    yield WORD
    for kind in kinds:
        place = f"outputs/{folder_of(kind)}/"
        found = [name for name in _names(place) if not name.startswith(".")]
        if len(found) <= _FEW or word.startswith(place):
            yield from (place + name for name in found)
        else:
            yield place
    if "/" in word:
        yield from files(word, folders_only=True)


def files(word: str, before: str = "", suffix: str = "", folders_only: bool = False) -> Iterator[str]:
    """Yield the paths that complete one, folders with a slash at their end.

    Args:
        word: What is typed.
        before: What stands in it before the path, as `--config-dir=`.
        suffix: What a file's name must end with.
        folders_only: Whether to leave files out.
    """
    path = word.removeprefix(before)
    name = path.rpartition("/")[2]
    parent = path.removesuffix(name)
    for entry in _entries(parent or "."):
        if entry.name.startswith(".") and not name.startswith("."):
            continue
        if entry.is_dir():
            yield f"{before}{parent}{entry.name}/"
        elif not folders_only and entry.name.endswith(suffix):
            yield f"{before}{parent}{entry.name}"


def _entries(folder: str) -> Iterator[os.DirEntry[str]]:
    try:
        with os.scandir(folder) as entries:
            yield from entries
    except OSError:
        return


def _names(folder: str) -> list[str]:
    return [entry.name for entry in _entries(folder) if entry.is_dir()]
