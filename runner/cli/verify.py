"""`runner verify [DIR]`: check the files of an outputs folder against their checksums.

A checksum detects corruption, such as a flipped bit or half a file; it does not detect forgery. Reports are derived
from stored data and have no checksums; baselines and claims are edited by people.
"""

from argparse import Namespace
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
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
    """State of one stored result.

    Attributes:
        kind: Folder of its kind, such as "runs".
        state: "good" if all checksums are right, "unfinished" if its writer was killed.
        problem: Damage, and the command that repairs it; empty if there is none.
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
    """Read all stored results in an outputs folder, and compare them with their checksums.

    Args:
        outputs: The outputs folder.

    Raises:
        SchemaError: at the first result of another schema.
    """
    from runner.store import DamagedError

    for kind, (pattern, needed) in _KINDS.items():
        for path in sorted((outputs / kind).glob(pattern)):
            if not all((path / name).exists() for name in needed):
                yield Found(kind, "unfinished")
                continue
            try:
                _read(kind, path)
                yield Found(kind, "good")
            except DamagedError as error:
                yield Found(kind, "damaged", str(error))


def _read(kind: str, path: Path) -> None:
    """Read a stored result with all its files, which compares them with their checksums."""
    from runner import store

    if kind == "runs":
        run = store.open_run(path)
        _ = run.urdf, run.units, [run.values(metric) for metric in run.metrics]
    elif kind == "calibrations":
        _ = store.open_calibration(path).urdf
    elif kind == "shards":
        from runner.store.shards import open_row, read_outcomes

        for row in range(len(read_outcomes(path))):
            open_row(path, row)
    elif kind in ("sweeps", "tunings"):
        from runner.sweeps.status import read_pace
        from runner.sweeps.tuning.study import open_tuning

        if kind == "tunings":
            open_tuning(path)
        read_pace(path)
        store.open_sweep(path)
    elif kind == "finer":
        from runner.store.finished import read_finer

        read_finer(path.parents[1], path.stem)
    else:
        from runner.store.seal import read_json

        read_json(path, "its command measures it again")


# Of each kind: the pattern of its paths, and the files without which one is unfinished.
_KINDS: Mapping[str, tuple[str, Sequence[str]]] = {
    "runs": ("[!.]*", ["metrics.json"]),
    "shards": ("[!.]*.parquet", []),
    "sweeps": ("[!.]*", ["sweep.json"]),
    "tunings": ("[!.]*", ["tuning.json", "journal.log", "sweep.json"]),
    "calibrations": ("[!.]*", ["result.json"]),
    "benchmarks": ("[!.]*.json", []),
    "claims": ("[!.]*.json", []),
    "finer": ("[!.]*.json", []),
}
