"""`runner verify [DIR]`: check the files of an outputs folder against their checksums.

A checksum detects corruption, such as a flipped bit or half a file; it does not detect forgery. Reports are derived
from stored data and have no checksums; baselines and claims are edited by people.
"""

from argparse import Namespace
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner.base import progress
from runner.base.environment_variables import quiet_environment
from runner.base.errors import RunnerError
from runner.cli.arguments import Parser
from runner.config.compose.user_settings import outputs_dir

State = Literal["good", "unfinished", "damaged"]
_WORDS: Mapping[State, str] = {"good": "as written", "unfinished": "unfinished", "damaged": "damaged"}


@dataclass(frozen=True)
class Found:
    """What was found of one thing stored.

    Attributes:
        kind: The folder that it lies in, such as "runs".
        state: Whether all its digests are right; unfinished where its writer was killed.
        problem: What is damaged and what makes it anew, in words; empty where nothing is.
    """

    kind: str
    state: State
    problem: str = ""


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "outputs", nargs="?", type=Path, default=outputs_dir(), metavar="DIR", help="an outputs folder (./outputs)"
    )


def run(options: Namespace) -> int:
    """Print the numbers of stored results, and those that are damaged; return 1 if there are any."""
    if not options.outputs.is_dir():
        raise RunnerError(f"no folder {options.outputs}; name an outputs folder, as in `runner verify outputs`")
    quiet_environment()
    found = []
    progress.begin("verifying", unit="files")
    for each in verify(options.outputs):
        found.append(each)
        progress.step()
    counts = Counter((each.kind, each.state) for each in found)
    for kind in dict.fromkeys(each.kind for each in found):
        states = (f"{counts[kind, state]} {words}" for state, words in _WORDS.items() if counts[kind, state])
        print(f"{kind}: {', '.join(states)}")
    damaged = [each.problem for each in found if each.state == "damaged"]
    for problem in damaged:
        print(problem)
    if not found:
        print(f"nothing is stored in {options.outputs}")
    return 1 if damaged else 0


def verify(outputs: Path) -> Iterator[Found]:
    """Read everything that is stored in an outputs folder, and compare it with its digests.

    Args:
        outputs: The outputs folder.

    Raises:
        SchemaError: at the first thing of another schema.
    """
    from runner.store import DamagedError

    for kind, (pattern, needed, read) in _KINDS.items():
        for path in sorted((outputs / kind).glob(pattern)):
            if not all((path / name).exists() for name in needed):
                yield Found(kind, "unfinished")
                continue
            try:
                read(path)
                yield Found(kind, "good")
            except DamagedError as error:
                yield Found(kind, "damaged", str(error))


def _run(folder: Path) -> None:
    from runner.store import open_run

    run = open_run(folder)
    # Reads their files, and compares them with their digests.
    _ = run.urdf, run.units, [run.values(metric) for metric in run.metrics]


def _calibration(folder: Path) -> None:
    from runner.store import open_calibration

    _ = open_calibration(folder).urdf  # reads its file, and compares it with its digest


def _shard(path: Path) -> None:
    from runner.store.shards import open_row, read_outcomes

    for row in range(len(read_outcomes(path))):
        open_row(path, row)


def _sweep(folder: Path) -> None:
    from runner.store import open_sweep
    from runner.sweeps.status import read_pace

    read_pace(folder)
    open_sweep(folder)


def _tuning(folder: Path) -> None:
    from runner.sweeps.tuning.study import open_tuning

    open_tuning(folder)
    _sweep(folder)


def _benchmark(path: Path) -> None:
    from runner.store.seal import read_json

    read_json(path, "its command measures it again")


def _finer(path: Path) -> None:
    from runner.store.finer import read_finer

    read_finer(path.parents[1], path.stem)


# Of each folder what lies in it, the files without which that is unfinished, and what reads it.
_KINDS: dict[str, tuple[str, Sequence[str], Callable[[Path], None]]] = {
    "runs": ("[!.]*", ["metrics.json"], _run),
    "shards": ("[!.]*.parquet", [], _shard),
    "sweeps": ("[!.]*", ["sweep.json"], _sweep),
    "tunings": ("[!.]*", ["tuning.json", "journal.log", "sweep.json"], _tuning),
    "calibrations": ("[!.]*", ["result.json"], _calibration),
    "benchmarks": ("[!.]*.json", [], _benchmark),
    "claims": ("[!.]*.json", [], _benchmark),
    "finer": ("[!.]*.json", [], _finer),
}
