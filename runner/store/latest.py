"""The name `latest`: the most recent folder of each kind in an outputs folder."""

import json
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal

from runner.base.errors import RunnerError, StoreError
from runner.config.compose.user_settings import outputs_dir

Kind = Literal["run", "sweep", "tuning", "calibration", "report"]
WORD = "latest"

_NOTES = "newest"  # folder in an outputs folder: a file for each kind, so that two processes spoil nothing
_FOLDERS: Mapping[Kind, str] = {
    "run": "runs", "sweep": "sweeps", "tuning": "tunings", "calibration": "calibrations", "report": "reports",
}  # fmt: skip
# Files by which a folder is told, in this order: a tuning is a sweep, too, and all jobs have a config.
_FILES: Mapping[Kind, Sequence[str]] = {
    "tuning": ("tuning.json",),
    "sweep": ("sweep.json",),
    "calibration": ("result.json",),
    "run": ("metrics.json", "config.yaml", "trace.parquet"),
    "report": ("report.html", "report.pdf"),
}
_MADE_BY: Mapping[Kind, str] = {
    "run": "runner OVERRIDES",
    "sweep": "runner -m OVERRIDES",
    "tuning": "runner tune",
    "calibration": "runner calibrate",
    "report": "runner report",
}


def note(folder: Path) -> None:
    """Keep that a folder, such as outputs/runs/NAME, is what was made or found last of its kind.

    An outputs folder that cannot be written still gives what is stored in it: that is told, and nothing else.
    """
    from runner.store.atomic import write_atomically  # a room that reading a note does without

    place = folder.resolve()
    outputs, kind = place.parent.parent, place.parent.name
    if kind not in _FOLDERS.values():
        return  # a copy that lies elsewhere
    order = max([time.time_ns(), *(known + 1 for known, _ in _notes(outputs, tuple(_FOLDERS)))])
    try:
        content = json.dumps({"name": place.name, "order": order}).encode()
        write_atomically(outputs / _NOTES / f"{kind}.json", content, flush=False)
    except StoreError as error:
        print(f"runner: `{WORD}` will not mean {folder}: {error}", file=sys.stderr)


def find_folder(text: str | Path, kinds: Sequence[Kind]) -> Path:
    """Return the folder that a user names: by its path, by `latest`, or by OUTPUTS/latest in another outputs folder.

    A folder that has the name `latest` is that folder. All is told from the names of files, without reading them.

    Args:
        text: What was typed.
        kinds: What it may be the folder of.

    Raises:
        RunnerError: if there is no such folder, or it is of another kind; if nothing was made yet, or is gone.
    """
    path = Path(text)
    if path.name == WORD and not path.exists():
        return _newest(outputs_dir() if str(text) == WORD else path.parent, kinds)
    if not path.is_dir():
        raise RunnerError(f"no folder {path}; needed: {_needed(kinds)}")
    kind = kind_of(path)
    if kind not in kinds:
        what = "nothing that is stored" if kind is None else f"the folder of a {kind}"
        raise RunnerError(f"{path} is {what}; needed: {_needed(kinds)}")
    return path


def folder_of(kind: Kind) -> str:
    """Return the name of the folder in an outputs folder that a kind of thing lies in."""
    return _FOLDERS[kind]


def kind_of(folder: Path) -> Kind | None:
    """Return what a folder holds, finished or not, by the names of its files; None for any other folder."""
    return next((kind for kind, files in _FILES.items() if any((folder / name).exists() for name in files)), None)


def _newest(outputs: Path, kinds: Sequence[Kind]) -> Path:
    found = max(_notes(outputs, kinds), default=None)
    if found is None:
        raise RunnerError(
            f"no {' or '.join(kinds)} was made in {outputs} yet that `{WORD}` could mean; needed: {_needed(kinds)}"
        )
    if not found[1].is_dir():
        raise RunnerError(f"{found[1]} was the latest and is gone; needed: {_needed(kinds)}")
    return found[1]


def _notes(outputs: Path, kinds: Sequence[Kind]) -> Iterator[tuple[int, Path]]:
    """Yield the order and the folder of what was last of some kinds; what cannot be read is as if it were not there."""
    for kind in kinds:
        try:
            content = json.loads((outputs / _NOTES / f"{_FOLDERS[kind]}.json").read_bytes())
            order, name = int(content["order"]), str(content["name"])
        except (OSError, ValueError, TypeError, KeyError):
            continue
        if name == Path(name).name:  # none that leads out of the folder
            yield order, outputs / _FOLDERS[kind] / name


def _needed(kinds: Sequence[Kind]) -> str:
    named = ", ".join(f"a {kind} (`{_MADE_BY[kind]}` prints it)" for kind in kinds)
    return f"the folder of {named}, or the word {WORD}"
