"""Expected caveats of a study, read from `caveats.yaml`."""

from pathlib import Path
from typing import Annotated

from pydantic import Field

from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.metrics.caveats.plant_error import DEFAULT_PLANT
from runner.metrics.caveats.registry import KEYS
from runner.schema.model import StrictModel
from runner.study.expected_caveats import ExpectedCaveat

FILE = "caveats.yaml"
_OF_THE_MACHINE = ExpectedCaveat(
    DEFAULT_PLANT.name, "*", "PyBullet was not installed; conclusions and verdicts are stated for it, and may differ."
)
_Texts = Annotated[list[Annotated[str, Field(min_length=1)]], Field(min_length=1)]


class Entry(StrictModel):
    """Some caveats of some runs that are expected for one reason.

    Attributes:
        rules: Names of the rules that find them.
        runs: Patterns of the names of the runs, such as "figure_5_*/as_reported".
        why: Why they are there, and why the work's conclusions stand; a sentence.
    """

    rules: _Texts
    runs: _Texts
    why: Annotated[str, Field(min_length=1)]


def read_expected(folder: Path) -> tuple[ExpectedCaveat, ...]:
    """Return the caveats that a work expects: those of its file, if it has one, and one that is the machine's.

    Raises:
        RunnerError: if the file does not fit, or names a rule that does not exist; tells entry and key.
    """
    path = folder / FILE
    if not path.is_file():
        return (_OF_THE_MACHINE,)
    entries = read_data(path, list[Entry])
    for rule in (rule for entry in entries for rule in entry.rules):
        if rule not in KEYS:
            raise RunnerError(f"{path}: there is no rule '{rule}'{nearest(rule, KEYS)}; rules: {', '.join(KEYS)}")
    listed = (ExpectedCaveat(rule, runs, entry.why) for entry in entries for runs in entry.runs for rule in entry.rules)
    return (*listed, _OF_THE_MACHINE)
