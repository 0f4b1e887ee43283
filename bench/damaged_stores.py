"""Damage to a stored outputs folder: what is done to its files, and what reading them then gives."""

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner import store
from runner.errors import StoreError
from runner.store.shards import open_row, read_outcomes, shard_files
from runner.sweeps.status import read_pace
from runner.tuning.study import open_tuning


@dataclass(frozen=True)
class Reading:
    """What reading a store gave.

    Attributes:
        values: What each thing stored holds, by its place; missing where it is refused.
        told: What was said of those that are refused, by place.
    """

    values: dict[str, object]
    told: dict[str, str]


def read_all(outputs: Path, beside: Path | None = None) -> Reading:
    """Read everything in an outputs folder that a number could be printed from, or what lies beside one file."""
    reading = Reading({}, {})
    for place, read in _things(outputs):
        if beside is not None and not place.startswith(str(beside.parent)):
            continue
        try:
            reading.values[place] = read()
        except StoreError as error:
            reading.told[place] = str(error)
    return reading


def _things(outputs: Path) -> Iterator[tuple[str, object]]:
    for folder in sorted((outputs / "runs").iterdir()):
        yield f"{folder}", lambda folder=folder: _run(store.open_run(folder))
        yield f"{folder}/trace", lambda folder=folder: _trace(store.open_run(folder))
        yield f"{folder}/urdf", lambda folder=folder: store.open_run(folder).urdf
    for path in shard_files(outputs):
        yield f"{path.parent}/{path.name[:27]}", lambda path=path: _shard(path)
    for folder in sorted((outputs / "sweeps").iterdir()):
        yield f"{folder}", lambda folder=folder: _sweep(folder)
        yield f"{folder}/progress", lambda folder=folder: read_pace(folder)
    for folder in sorted((outputs / "tunings").iterdir()):
        yield f"{folder}", lambda folder=folder: open_tuning(folder)
        yield f"{folder}/sweep", lambda folder=folder: _sweep(folder)
    for folder in sorted((outputs / "calibrations").iterdir()):
        yield f"{folder}", lambda folder=folder: _run(store.open_calibration(folder))
        yield f"{folder}/urdf", lambda folder=folder: store.open_calibration(folder).urdf


def _run(run: store.Run | store.Calibration) -> object:
    return run.config, {key: run.record[key] for key in run.record if key != "digest"}, run.sealed


def _trace(run: store.Run) -> object:
    return list(run.trace.columns), run.trace.to_numpy().tobytes(), run.units


def _shard(path: Path) -> object:
    ends = read_outcomes(path)
    return ends, [(_run(run), run.urdf) for run in (open_row(path, row) for row in range(len(ends)))]


def _sweep(folder: Path) -> object:
    sweep = store.open_sweep(folder)
    return sweep.overrides, sweep.hashes, sweep.command, sweep.sealed


def files_of(outputs: Path) -> list[Path]:
    """Return the files of a store that are read again."""
    files = [path for path in outputs.rglob("*") if path.is_file() and "reports" not in path.parts]
    return sorted(path for path in files if path.parent.name != "logs" and not path.name.startswith("table."))


def flip(path: Path, draw: random.Random) -> bytes:
    """Flip one bit of a file; return what it held."""
    content = path.read_bytes()
    place = draw.randrange(len(content))
    changed = bytearray(content)
    changed[place] ^= 1 << draw.randrange(8)
    path.write_bytes(bytes(changed))
    return content


def damage(path: Path, others: Sequence[Path], draw: random.Random) -> bytes:
    """Damage a file in one of many ways; return what it held."""
    content = path.read_bytes()
    first, last = sorted((draw.randrange(len(content) + 1), draw.randrange(len(content) + 1)))
    ways = [
        content[:first],
        content[:first] + content[last:],
        content[:first] + content[first:last] * 2 + content[last:],
        content[:first] + draw.randbytes(last - first) + content[last:],
        b"",
        draw.choice(others).read_bytes(),
        b"[" * 50_000,
        b"9" * 6_000,
        b'{"schema": 1}',
        b'{"schema": 99, "jobs": [3]}',
        b"a: &a [1, 1]\nb: &b [*a, *a]\nc: [*b, *b]\n",
        content.replace(b"1", b"null", 3),
        content.replace(b"{", b"[", 1),
    ]
    path.write_bytes(draw.choice(ways))
    return content
