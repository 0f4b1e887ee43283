"""List of everything in an outputs folder, and removal of what is old and not needed by what stays."""

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.base.errors import StoreError
from runner.store.kinds import KINDS, Kind
from runner.store.seal import read_json
from runner.store.sweep import open_sweep

_OF_SWEEPS: tuple[Kind, ...] = ("sweep", "tuning")


@dataclass(frozen=True)
class Entry:
    """A stored result.

    Attributes:
        kind: Its kind.
        folder: Its folder.
        written: Time at which its first file was last written, in s since 1970.
        size: Size of its files, in bytes.
        finished: Whether it has all its files.
    """

    kind: Kind
    folder: Path
    written: float
    size: int
    finished: bool


def list_entries(outputs: Path) -> list[Entry]:
    """Return all stored results of an outputs folder, the newest first; those in shards have no folder of their own.

    Raises:
        StoreError: if there is no such folder.
    """
    if not outputs.is_dir():
        raise StoreError(f"{outputs}: no such folder. Allowed: an outputs folder.")
    found = [entry for kind, of in KINDS.items() for entry in _entries(kind, outputs / of.folder)]
    return sorted(found, key=lambda entry: (-entry.written, str(entry.folder)))


def runs_of_sweeps(entries: Sequence[Entry]) -> set[str]:
    """Return the names of the runs that belong to sweeps and tunings.

    Raises:
        StoreError: if one of these is damaged.
    """
    names = set[str]()
    for entry in entries:
        if entry.kind in _OF_SWEEPS and entry.finished:
            names.update(open_sweep(entry.folder).hashes)
        if entry.kind == "tuning" and entry.finished:
            fresh = read_json(entry.folder / KINDS["tuning"].files[0], "the tuning's command makes it again")["fresh"]
            names |= {fresh["default"], fresh["tuned"]} if fresh else set()
    return names


def removable(entries: Sequence[Entry], before: float) -> list[Entry]:
    """Return the results that were written before a time, without the runs of sweeps and tunings that stay.

    Args:
        entries: All results of an outputs folder.
        before: Time in s since 1970.

    Raises:
        StoreError: if a sweep that stays is damaged, so that its runs are not known.
    """
    kept = runs_of_sweeps([entry for entry in entries if entry.written >= before])
    return [entry for entry in entries
            if entry.written < before and not (entry.kind == "run" and entry.folder.name in kept)]  # fmt: skip


def remove(entries: Sequence[Entry]) -> None:
    """Remove results with all their files: sweeps before their runs, so that none lacks a run.

    Raises:
        StoreError: if a file cannot be removed.
    """
    for entry in sorted(entries, key=lambda entry: entry.kind not in _OF_SWEEPS):
        try:
            shutil.rmtree(entry.folder)
        except OSError as error:
            raise StoreError(f"cannot remove {entry.folder}: {error.strerror}") from error


def _entries(kind: Kind, folder: Path) -> Iterator[Entry]:
    of = KINDS[kind]
    for path in folder.glob("[!.]*"):
        files = [each for each in path.rglob("*") if each.is_file()] if path.is_dir() and not path.is_symlink() else []
        marks = [path / name for name in of.files if (path / name).is_file()]
        if not marks:
            continue
        needed = (*of.files[:1], *of.more) if kind != "report" else ()
        size = sum(each.stat().st_size for each in files)
        finished = all((path / name).exists() for name in needed)
        yield Entry(kind, path, marks[0].stat().st_mtime, size, finished)
