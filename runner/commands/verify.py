"""`runner verify [DIR]`: is everything in an outputs folder as it was written?

A digest finds accidents, as a flipped bit or half a file; it does not find forgery. Reports are made from what is
stored and have none; references and claims are edited by people.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner import progress
from runner.commands.arguments import Parser
from runner.errors import RunnerError, StoreError
from runner.quiet import quiet_environment

State = Literal["good", "unsealed", "unfinished", "damaged"]
_WORDS: Mapping[State, str] = {
    "good": "as written",
    "unsealed": "without digests",
    "unfinished": "unfinished",
    "damaged": "damaged",
}


@dataclass(frozen=True)
class Found:
    """What was found of one thing stored.

    Attributes:
        kind: The folder that it lies in, such as "runs".
        state: Whether all its digests are right; unsealed where it has none, unfinished where its writer was killed.
        problem: What is damaged and what makes it anew, in words; empty where nothing is.
    """

    kind: str
    state: State
    problem: str = ""


def main(arguments: Sequence[str]) -> int:
    """Print what is stored, and what of it is damaged; return 1 where anything is."""
    parser = Parser("verify", __doc__)
    parser.add_argument(
        "outputs", nargs="?", type=Path, default=Path("outputs"), metavar="DIR", help="an outputs folder (./outputs)"
    )
    options = parser.parse_args(arguments)
    if not options.outputs.is_dir():
        raise RunnerError(f"no folder {options.outputs}; name an outputs folder, as in `runner verify outputs`")
    quiet_environment()
    found = []
    progress.begin("verifying", total=None, unit="things")
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
    """
    for kind, (pattern, look) in _KINDS.items():
        for path in sorted((outputs / kind).glob(pattern)):
            try:
                yield Found(kind, look(path))
            except StoreError as error:
                yield Found(kind, "damaged", str(error))


def _run(folder: Path) -> State:
    from runner.store import open_run

    if not (folder / "metrics.json").exists():
        return "unfinished"
    run = open_run(folder)
    # Reads their files, and compares them with their digests.
    _ = run.urdf, run.units, [run.values(metric) for metric in run.metrics]
    return _state(run.sealed)


def _calibration(folder: Path) -> State:
    from runner.store import open_calibration

    if not (folder / "result.json").exists():
        return "unfinished"
    calibration = open_calibration(folder)
    _ = calibration.urdf  # reads its file, and compares it with its digest
    return _state(calibration.sealed)


def _shard(path: Path) -> State:
    from runner.store.shards import is_sealed_shard, open_row, read_outcomes

    for row in range(len(read_outcomes(path))):
        open_row(path, row)
    return _state(is_sealed_shard(path))


def _sweep(folder: Path) -> State:
    from runner.store import open_sweep
    from runner.sweeps.status import read_pace

    if not (folder / "sweep.json").exists():
        return "unfinished"
    read_pace(folder)
    return _state(open_sweep(folder).sealed)


def _tuning(folder: Path) -> State:
    from runner.tuning.study import is_tuning, journal_path, open_tuning

    if not (is_tuning(folder) and journal_path(folder).exists()):
        return "unfinished"
    return _state(open_tuning(folder).sealed and _sweep(folder) == "good")


def _benchmark(path: Path) -> State:
    from runner.store.seal import is_sealed, read_json

    return _state(is_sealed(read_json(path, "its command measures it again")))


def _state(sealed: bool) -> State:
    return "good" if sealed else "unsealed"


_KINDS: dict[str, tuple[str, Callable[[Path], State]]] = {
    "runs": ("[!.]*", _run),
    "shards": ("[!.]*.parquet", _shard),
    "sweeps": ("[!.]*", _sweep),
    "tunings": ("[!.]*", _tuning),
    "calibrations": ("[!.]*", _calibration),
    "benchmarks": ("[!.]*.json", _benchmark),
}
