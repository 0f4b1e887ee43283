"""List of everything in an outputs folder, and removal of what is old and not needed by what stays."""

import os
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner.base.errors import StoreError
from runner.store.kinds import KINDS, Kind
from runner.store.seal import DamagedError, read_json
from runner.store.sweep import open_sweep

_OF_SWEEPS: tuple[Kind, ...] = ("sweep", "tuning", "challenge")


@dataclass(frozen=True)
class ListedResult:
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

    @property
    def link(self) -> Path | None:
        """Link in the outputs folder that leads to it, so that its files lie elsewhere; None if there is none."""
        return next((path for path in (self.folder.parent, self.folder) if path.is_symlink()), None)


def list_entries(outputs: Path) -> list[ListedResult]:
    """Return all stored results of an outputs folder, the newest first; those in shards have no folder of their own.

    Raises:
        StoreError: if there is no such folder.
    """
    if not outputs.is_dir():
        raise StoreError(f"{outputs}: no such folder. Allowed: an outputs folder.")
    found = [entry for kind, of in KINDS.items() for entry in _entries(kind, outputs / of.folder)]
    return sorted(found, key=lambda entry: (-entry.written, str(entry.folder)))


def runs_of_sweeps(entries: Sequence[ListedResult]) -> set[str]:
    """Return the names of the runs that belong to sweeps, tunings and challenges.

    Raises:
        StoreError: if one of these is damaged, or of another version.
    """
    names = set[str]()
    for entry in entries:
        if entry.kind in _OF_SWEEPS and entry.finished:
            names.update(open_sweep(entry.folder).hashes)
        if entry.kind == "tuning" and entry.finished:
            names |= _fresh_runs(entry.folder / KINDS["tuning"].files[0])
    return names


def _fresh_runs(path: Path) -> set[str]:
    """Return the names of the runs of a tuning on a fresh seed."""
    remedy = "the tuning's command makes it again"
    fresh = read_json(path, remedy).get("fresh")
    if not fresh:
        return set()
    try:
        return {str(fresh[name]) for name in ("default", "tuned")}
    except (LookupError, TypeError) as error:
        raise DamagedError(f"cannot read {path}: fresh does not name two runs; {remedy}") from error


def removable(entries: Sequence[ListedResult], before: float) -> tuple[list[ListedResult], list[str]]:
    """Return the results that were written before a time and can be removed, and the reasons why others stay.

    Runs of sweeps and tunings that stay also stay, and so does a result that a link leads to.

    Args:
        entries: All results of an outputs folder.
        before: Time in s since 1970.
    """
    old = [entry for entry in entries if entry.written < before]
    links = dict.fromkeys(entry.link for entry in old if entry.link)
    why = [f"{link}: it is a link, and nothing that it leads to is removed" for link in links]
    kept, unknown = set[str](), False
    for entry in entries:
        if entry.written >= before:
            try:
                kept |= runs_of_sweeps([entry])
            except StoreError as error:
                unknown = True
                why.append(f"{error}. Its runs are not known, and no run is removed")
    found = [entry for entry in old
             if not entry.link and not (entry.kind == "run" and (unknown or entry.folder.name in kept))]  # fmt: skip
    return found, why


def remove(entries: Sequence[ListedResult]) -> None:
    """Remove results with all their files: sweeps before their runs, so that none lacks a run.

    Raises:
        StoreError: if a file cannot be removed.
    """
    for entry in sorted(entries, key=lambda entry: entry.kind not in _OF_SWEEPS):
        try:
            shutil.rmtree(entry.folder)
        except OSError as error:
            raise StoreError(f"cannot remove {entry.folder}: {error.strerror or error.args[0]}") from error


def _entries(kind: Kind, folder: Path) -> Iterator[ListedResult]:
    of = KINDS[kind]
    for path in folder.glob("[!.]*"):
        if not path.is_dir():
            continue
        files = dict(_files(path, deep=not path.is_symlink()))
        marks = [files[name] for name in of.files if name in files]
        if not marks:
            continue
        needed = (*of.files[:1], *of.more) if kind != "report" else ()
        size = sum(each.st_size for each in files.values())
        yield ListedResult(kind, path, marks[0].st_mtime, size, files.keys() >= set(needed))


def _files(folder: str | Path, within: str = "", deep: bool = True) -> Iterator[tuple[str, os.stat_result]]:
    """Yield path and status of the files in a folder, and in its own folders if `deep`."""
    with os.scandir(folder) as found:
        for each in found:
            if each.is_dir(follow_symlinks=False):
                if deep:
                    yield from _files(each.path, f"{within}{each.name}/")
            elif each.is_file():
                yield f"{within}{each.name}", each.stat()
