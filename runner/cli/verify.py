"""Compare the files of an outputs folder with their checksums.

A checksum detects corruption, such as a flipped bit or half a file; it does not detect forgery. Reports are derived
from stored data and have no checksums; baselines and claims are edited by people.

Example: runner verify
"""

from argparse import Namespace
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner.base import progress
from runner.base.errors import RunnerError
from runner.base.sanitize import one_line
from runner.cli.arguments import Parser
from runner.config.compose.files import outputs_dir
from runner.store.kinds import FILES, KINDS

State = Literal["good", "unfinished", "other version", "damaged"]
_WORDS: Mapping[State, str] = {
    "good": "as written", "unfinished": "unfinished", "other version": "of another version", "damaged": "damaged",
}  # fmt: skip


@dataclass(frozen=True)
class VerifiedResult:
    """State of one stored result.

    Attributes:
        kind: Folder of its kind, such as "runs".
        state: "good" if all checksums are right, "unfinished" if its writer was killed, "other version" if this
            version cannot read it.
        problem: Damage, and the command that repairs it; empty if there is none.
    """

    kind: str
    state: State
    problem: str = ""


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "outputs", nargs="?", type=Path, default=outputs_dir(), metavar="DIR", help="outputs folder (default: outputs)"
    )


def run(options: Namespace) -> int:
    """Print the numbers of stored results, and those that cannot be read; return 1 if there are any."""
    if not options.outputs.is_dir():
        allowed = "an outputs folder, as in `runner verify outputs`"
        raise RunnerError(f"{options.outputs}: no such folder. Allowed: {allowed}.")
    found = []
    progress.begin("verifying", unit="files")
    for each in verify(options.outputs):
        found.append(each)
        progress.step()
    counts = Counter((each.kind, each.state) for each in found)
    for kind in dict.fromkeys(each.kind for each in found):
        states = (f"{counts[kind, state]} {words}" for state, words in _WORDS.items() if counts[kind, state])
        print(f"{kind}: {', '.join(states)}")
    problems = [each.problem for each in found if each.problem]
    for problem in problems:
        print(one_line(problem))
    if not found:
        print(f"nothing is stored in {options.outputs}")
    return 1 if problems else 0


def verify(outputs: Path) -> Iterator[VerifiedResult]:
    """Read all stored results in an outputs folder, and compare them with their checksums.

    Args:
        outputs: The outputs folder.
    """
    from runner.store.seal import DamagedError, SchemaError

    folders = {of.folder: of for kind, of in KINDS.items() if kind != "report"}
    for name in sorted({*folders, *FILES}):
        for path in sorted((outputs / name).glob(FILES.get(name, "[!.]*"))):
            needed = (folders[name].files[0], *folders[name].more) if name in folders else ()
            if not all((path / each).exists() for each in needed):
                yield VerifiedResult(name, "unfinished")
                continue
            try:
                _read(name, path)
                yield VerifiedResult(name, "good")
            except SchemaError as error:
                yield VerifiedResult(name, "other version", str(error))
            except DamagedError as error:
                yield VerifiedResult(name, "damaged", str(error))


def _read(name: str, path: Path) -> None:
    """Read a stored result with all its files, which compares them with their checksums."""
    from runner import store

    if name == "shards":
        from runner.store.shards import open_row, read_outcomes

        for row in range(len(read_outcomes(path))):
            open_row(path, row)
    elif name in FILES:
        from runner.store.seal import read_json

        read_json(path, "its command measures it again")
    elif name == "identifications":
        from runner.identification.result import open_identification

        open_identification(path)
    elif name == "challenges":
        from runner.sweeps.challenge.stored import open_challenge

        open_challenge(path)
        store.open_sweep(path)
    elif name in ("sweeps", "tunings"):
        from runner.sweeps.status import read_pace
        from runner.sweeps.tuning.study import open_tuning

        if name == "tunings":
            open_tuning(path)
        read_pace(path)
        store.open_sweep(path)
    else:
        found = store.open_run(path) if name == "runs" else store.open_calibration(path)
        _ = found.urdf
        if isinstance(found, store.Run):
            _ = found.units, [found.values(metric) for metric in found.metrics]
