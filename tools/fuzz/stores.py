"""Damage to a stored outputs folder: what is done to its files, and what reading them then gives.

No damage may be read as something else, or end a command with a traceback.
"""

import contextlib
import io
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from runner import store
from runner.base.atomic import write_atomically
from runner.base.errors import StoreError
from runner.cli.main import dispatch
from runner.config.compose.composer import Composer
from runner.metrics.summary import MOST_LISTED
from runner.store.seal import sealed_json
from runner.store.shards import open_row, read_outcomes, shard_files
from runner.sweeps.job import calibrate, run
from runner.sweeps.plan import Grid
from runner.sweeps.run import Engine, run_sweep
from runner.sweeps.status import read_pace
from runner.sweeps.tuning.objective import Objective
from runner.sweeps.tuning.run import tune
from runner.sweeps.tuning.study import open_tuning


@dataclass(frozen=True)
class Reading:
    """Result of reading a store.

    Attributes:
        values: What each thing stored holds, by its place; missing where it is refused.
        told: Message on each refused thing, by place.
    """

    values: dict[str, object]
    told: dict[str, str]


def read_all(outputs: Path, beside: Path | None = None) -> Reading:
    """Read everything in an outputs folder that a number could be printed from, or what lies next to one file."""
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
        yield f"{folder}/values", lambda folder=folder: _values(store.open_run(folder))
    for path in shard_files(outputs):
        yield f"{path.parent}/{path.name.partition('.')[0]}", lambda path=path: _shard(path)
    for folder in sorted((outputs / "sweeps").iterdir()):
        yield f"{folder}", lambda folder=folder: _sweep(folder)
        yield f"{folder}/progress", lambda folder=folder: read_pace(folder)
    for folder in sorted((outputs / "tunings").iterdir()):
        yield f"{folder}", lambda folder=folder: open_tuning(folder)
        yield f"{folder}/sweep", lambda folder=folder: _sweep(folder)
        yield f"{folder}/progress", lambda folder=folder: read_pace(folder)
    for folder in sorted((outputs / "calibrations").iterdir()):
        yield f"{folder}", lambda folder=folder: _run(store.open_calibration(folder))
        yield f"{folder}/urdf", lambda folder=folder: store.open_calibration(folder).urdf


def _run(run: store.Run | store.Calibration) -> object:
    return run.config, {key: run.record[key] for key in run.record if key != "digest"}


def _trace(run: store.Run) -> object:
    return list(run.trace().columns), run.trace().to_numpy().tobytes(), run.units


def _values(run: store.Run) -> object:
    return {name: run.values(name).tobytes() for name in run.metrics}


def _shard(path: Path) -> object:
    ends = list(read_outcomes(path))
    return ends, [(_run(run), run.urdf) for run in (open_row(path, row) for row in range(len(ends)))]


def _sweep(folder: Path) -> object:
    sweep = store.open_sweep(folder)
    return sweep.overrides, sweep.hashes, sweep.command


def files_of(outputs: Path) -> list[Path]:
    """Return the files of a store that results are read from; what `latest` means is none of them."""
    files = [path for path in outputs.rglob("*") if path.is_file() and not {"reports", "newest"} & set(path.parts)]
    return sorted(path for path in files if path.parent.name != "logs" and not path.name.startswith("table."))


def flip(path: Path, draw: random.Random) -> bytes:
    """Flip one bit of a file; return its former content."""
    content = path.read_bytes()
    place = draw.randrange(len(content))
    changed = bytearray(content)
    changed[place] ^= 1 << draw.randrange(8)
    path.write_bytes(bytes(changed))
    return content


def damage(path: Path, others: Sequence[Path], draw: random.Random) -> bytes:
    """Damage a file in one of many ways; return its former content."""
    content = path.read_bytes()
    first, last = sorted((draw.randrange(len(content) + 1), draw.randrange(len(content) + 1)))
    ways = [
        content[:first],
        content[:first] + content[last:],
        content[:first] + content[first:last] * 2 + content[last:],
        content[:first] + draw.randbytes(last - first) + content[last:],
        b"",
        draw.choice(_strangers(path, others)).read_bytes(),
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


def _strangers(path: Path, others: Sequence[Path]) -> list[Path]:
    """Return the files that one may not be taken for; a whole list of a sweep's jobs is one in any folder."""
    return [other for other in others if path.name != "sweep.json" or other.name != path.name]


def make_store(outputs: Path) -> None:
    """Make a store with every kind of file: runs, shards, sweeps, a tuning, a calibration, notes of progress."""
    here = Engine(0, None)
    given = ("robot=macro", "duration=0.03", f"outputs={outputs}")
    for more in (("seed=0,1",), ("seed=2,3,4", "sweep.trace=never", "noise=thesis", "repetitions=3")):
        swept = run_sweep(Grid([*given, *more], Composer()), here, "runner -m").folder
        write_atomically(swept / "progress.json", sealed_json({"seconds_per_run": 0.5}))
    run(*given, "plant=rk4", "noise=thesis", f"repetitions={MOST_LISTED + 1}")
    key = "controller.damping_ratio=interval(0.5,1.5)"
    tune([*given, key, "hydra.sweeper.workers=0"], [Objective("peak_torque", "minimize")], 3, 2, "runner tune")
    calibrate("calibration=tool_direction", "repetitions=2", f"outputs={outputs}")


def flip_bits(outputs: Path, cases: int, seed: int) -> Iterator[str]:
    """Flip single bits, each kind of file as often; yield what is misread, or is reported without its name."""
    draw, whole = random.Random(seed), read_all(outputs)  # noqa: S311
    kinds: dict[str, list[Path]] = {}
    for path in files_of(outputs):
        kinds.setdefault("shards" if path.parent.name == "shards" else path.name, []).append(path)
    for _ in range(cases):
        path = draw.choice(kinds[draw.choice(sorted(kinds))])
        content = flip(path, draw)
        found = read_all(outputs, path)
        path.write_bytes(content)
        if not found.told or any(whole.values[place] != value for place, value in found.values.items()):
            yield f"{path}: a flipped bit is not noticed"
        if not all(path.name in told for told in found.told.values()):
            yield f"{path}: a flipped bit is reported for another file: {found.told}"


def damage_files(outputs: Path, cases: int, seed: int, commands: bool = False) -> Iterator[str]:
    """Damage files in other ways; yield what is misread or not reported, and the commands that crash."""
    draw = random.Random(seed)  # noqa: S311
    whole, files = read_all(outputs), files_of(outputs)
    for _ in range(cases):
        path = draw.choice(files)
        content = damage(path, files, draw)
        changed = path.read_bytes() != content
        found = read_all(outputs, path)
        crashes = list(_crashes(outputs)) if commands else []
        path.write_bytes(content)
        if any(whole.values[place] != value for place, value in found.values.items()):
            yield f"{path}: damage is read as something else"
        if bool(found.told) != changed or not all(str(path.parent) in told for told in found.told.values()):
            yield f"{path}: damage is not reported: {found.told}"
        yield from (f"{path}: {crash}" for crash in crashes)


def _crashes(outputs: Path) -> Iterator[str]:
    """Yield what commands that read a store end with, where that is not an ending of theirs."""
    runs, sweeps = sorted((outputs / "runs").iterdir()), sorted((outputs / "sweeps").iterdir())
    tunings = sorted((outputs / "tunings").iterdir())
    lines = [("verify", outputs), ("compare", runs[0], runs[1]), ("check", runs[0])]
    lines += [(command, folder) for command in ("status", "table", "check") for folder in (*sweeps, *tunings)]
    for line in lines:
        try:
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                code: object = dispatch([str(word) for word in line])
        except Exception as error:
            code = f"{type(error).__name__}: {error}"
        if code not in (0, 1, 2):
            yield f"`runner {line[0]}` ends with {code}"
