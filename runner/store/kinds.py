"""Kinds of stored results: folder, files and command of each, the name `latest`, and the outputs folder."""

import json
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner.base.bounded_json import decode_json
from runner.base.errors import RunnerError, StoreError
from runner.config.compose.files import outputs_dir

Kind = Literal["run", "sweep", "tuning", "challenge", "calibration", "identification", "report"]
WORD = "latest"

_NOTES = "newest"  # folder in an outputs folder: a file for each kind, so that two processes cannot damage one file


@dataclass(frozen=True)
class StoredKind:
    """Folder, files and command of a kind of stored result.

    Attributes:
        folder: Name of its parent folder in the outputs folder.
        files: Files by which a result's folder is recognized, the record first.
        command: Command that creates such a result.
        more: Files that a finished result also has.
    """

    folder: str
    files: Sequence[str]
    command: str
    more: Sequence[str] = ()


# In the order in which a folder is recognized: a tuning and a challenge are also sweeps, and all jobs have a config.
KINDS: Mapping[Kind, StoredKind] = {
    "tuning": StoredKind("tunings", ("tuning.json",), "runner tune", ("journal.log", "sweep.json")),
    "challenge": StoredKind("challenges", ("challenge.json",), "runner challenge RESULT", ("sweep.json",)),
    "sweep": StoredKind("sweeps", ("sweep.json",), "runner -m OVERRIDES"),
    "calibration": StoredKind("calibrations", ("result.json",), "runner calibrate"),
    "identification": StoredKind("identifications", ("identification.json",), "runner identify LOG"),
    "run": StoredKind("runs", ("metrics.json", "config.yaml", "trace.parquet"), "runner OVERRIDES"),
    "report": StoredKind("reports", ("report.html", "report.pdf"), "runner report"),
}

FILES: Mapping[str, str] = {
    "benchmarks": "[!.]*.json", "claims": "[!.]*.json", "finer": "[!.]*.json", "shards": "[!.]*.parquet",
}  # fmt: skip
"""Folders in an outputs folder whose results are single files, and the pattern of their names."""


def note(folder: Path) -> None:
    """Record that a folder, such as outputs/runs/NAME, is the latest of its kind.

    An outputs folder that cannot be written to causes a message, not an error.
    """
    from runner.base.atomic import refuse_links, write_atomically  # not needed to read a note

    place = folder.resolve()
    outputs, kind = place.parent.parent, place.parent.name
    if all(each.folder != kind for each in KINDS.values()):
        return  # a copy elsewhere
    order = max([time.time_ns(), *(known + 1 for known, _ in _notes(outputs, tuple(KINDS)))])
    try:
        content = json.dumps({"name": place.name, "order": order}).encode()
        refuse_links(outputs, outputs / _NOTES)
        write_atomically(outputs / _NOTES / f"{kind}.json", content, flush=False)
    except StoreError as error:
        print(f"runner: `{WORD}` will not mean {folder}: {error}", file=sys.stderr)


def find_folder(text: str | Path, kinds: Sequence[Kind]) -> Path:
    """Return the folder that a user names: by its path, by `latest`, or by OUTPUTS/latest in another outputs folder.

    An existing folder named `latest` takes precedence. The kind follows from the file names; no file is read.

    Args:
        text: The name as typed.
        kinds: Allowed kinds.

    Raises:
        RunnerError: if the folder is missing or of another kind; if there is no latest folder.
    """
    path = Path(text)
    if path.name == WORD and not path.exists():
        return _newest(outputs_dir() if str(text) == WORD else path.parent, kinds)
    if not path.is_dir():
        raise RunnerError(f"{path}: no such folder. {_needed(kinds)}")
    kind = kind_of(path)
    if kind not in kinds:
        what = "not the folder of a stored result" if kind is None else f"the folder of a {kind}"
        raise RunnerError(f"{path}: it is {what}. {_needed(kinds)}")
    return path


def kind_of(folder: Path) -> Kind | None:
    """Return the kind of a folder, finished or not, from the names of its files; None for any other folder."""
    return next((kind for kind, of in KINDS.items() if any((folder / name).exists() for name in of.files)), None)


def outputs_of(folder: Path) -> Path:
    """Return the outputs folder of a stored result; ./outputs for a copy elsewhere."""
    stored = any(of.folder == folder.resolve().parent.name for of in KINDS.values())
    return folder.parent.parent if stored else outputs_dir()


def report_place(outputs: Path, name: str) -> Path:
    """Return the folder of a report in an outputs folder, to write to.

    Raises:
        StoreError: if it is a link, or lies in one.
    """
    from runner.base.atomic import refuse_links  # not needed to find a result

    folder = outputs / KINDS["report"].folder / name
    refuse_links(outputs, folder)
    return folder


def _newest(outputs: Path, kinds: Sequence[Kind]) -> Path:
    found = max(_notes(outputs, kinds), default=None)
    if found is None:
        raise RunnerError(f"{WORD}: no {' or '.join(kinds)} was made in {outputs} yet. {_needed(kinds)}")
    if not found[1].is_dir():
        raise RunnerError(f"{WORD}: {found[1]} no longer exists. {_needed(kinds)}")
    return found[1]


def _notes(outputs: Path, kinds: Sequence[Kind]) -> Iterator[tuple[int, Path]]:
    """Yield the order and the folder of the latest of some kinds; notes that cannot be read are ignored."""
    for kind in kinds:
        try:
            content = decode_json((outputs / _NOTES / f"{KINDS[kind].folder}.json").read_bytes())
            order, name = int(content["order"]), str(content["name"])
        except (OSError, ValueError, TypeError, KeyError):
            continue
        if name == Path(name).name:  # none that leads out of the folder
            yield order, outputs / KINDS[kind].folder / name


def _needed(kinds: Sequence[Kind]) -> str:
    named = ", ".join(f"a {kind} (`{KINDS[kind].command}` prints it)" for kind in kinds)
    return f"Allowed: the folder of {named}, or the word {WORD}."


def prepare(outputs: Path) -> None:
    """Check that results can be stored in a folder, before anything is computed.

    Raises:
        StoreError: if the folder cannot be created or written to, or a folder in it is a link.
    """
    from runner.base.atomic import refuse_links, write_atomically  # not needed to find a result

    for name in (*(kind.folder for kind in KINDS.values()), *FILES):
        refuse_links(outputs, outputs / name)
    probe = outputs / "runs" / ".writable"
    try:
        write_atomically(probe, b"")
    except StoreError as error:
        raise StoreError(f"{error}; choose a folder that can be written to, as in outputs=FOLDER") from error
    probe.unlink(missing_ok=True)
