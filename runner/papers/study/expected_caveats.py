"""Expected caveats of a study from `caveats.yaml`, with reasons, and unexpected caveats of its runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.config.judgement import THRESHOLDS
from runner.papers.study.results import distinct
from runner.reporting.document import Notice, ReportBlock, Section, Table, Text
from runner.reporting.markup import literal
from runner.reporting.table import numbers
from runner.schema.model import StrictModel
from runner.store import Run

_TOLD = 20  # unexpected caveats that the report names one by one


@dataclass(frozen=True)
class ExpectedCaveat:
    """A caveat that some runs of a study are to have.

    Attributes:
        rule: Name of the rule that finds it.
        runs: Pattern of the names of the runs, such as "figure_5_*/as_reported".
        why: Cause of the caveat, and why the study's conclusions hold nevertheless; a sentence.
    """

    rule: str
    runs: str
    why: str

    def covers(self, name: str, caveat: Mapping[str, Any]) -> bool:
        """Return True if it covers a caveat of the run of that name."""
        return str(caveat["rule"]) == self.rule and fnmatchcase(name, self.runs)


def unexpected_caveats(runs: Mapping[str, Run], expected: Sequence[ExpectedCaveat]) -> list[str]:
    """Return the caveats that a study does not expect, a line for each."""
    return [
        f"{name}: caveat {caveat['rule']}, which the study does not expect: {caveat['text']}"
        for name, run in runs.items()
        for caveat in run.caveats
        if not any(each.covers(name, caveat) for each in expected)
    ]


def caveats_as_data(runs: Mapping[str, Run], expected: Sequence[ExpectedCaveat]) -> list[dict[str, object]]:
    """Return every caveat of a study's runs, with why it is expected, or None, as plain data."""
    return [
        {
            "run": name,
            **{key: caveat[key] for key in ("rule", "text", "value")},
            "expected": next((each.why for each in expected if each.covers(name, caveat)), None),
        }
        for name, run in runs.items()
        for caveat in run.caveats
    ]


def caveats_section(runs: Mapping[str, Run], expected: Sequence[ExpectedCaveat]) -> Section:
    """Return the caveats of a study's runs with their causes, and a warning if one is not expected."""
    lines = unexpected_caveats(runs, expected)
    blocks: list[ReportBlock] = []
    if lines:
        more = f"; and {len(lines) - _TOLD} more" if len(lines) > _TOLD else ""
        text = literal(f"{'; '.join(lines[:_TOLD])}{more}.")
        blocks.append(
            Notice(
                "warning", f"{len(lines)} caveat{'s' if len(lines) > 1 else ''} that this study does not expect", text
            )
        )
    reasons = dict.fromkeys((each.rule, each.why) for each in expected)
    rows = [row for rule, why in reasons if (row := _row(rule, why, expected, runs)) is not None]
    blocks.append(
        Table(
            "Each caveat with the number of runs that have it, the worst of these, and why it was to be expected.",
            ["caveat", *numbers("runs"), "the worst of them", "why it is expected"],
            rows,
            prose=True,
        )
        if rows
        else Text("No rule found anything at the end of the runs.")
    )
    return Section("Caveats of the runs", tuple(blocks))


def _row(rule: str, why: str, expected: Sequence[ExpectedCaveat], runs: Mapping[str, Run]) -> list[str] | None:
    """Return the runs in which a rule finds what is expected for one reason, as a row; None where there is none."""
    patterns = [each for each in expected if (each.rule, each.why) == (rule, why)]
    found = [
        (float(caveat["value"]), name, str(caveat["text"]))
        for name, run in runs.items()
        for caveat in run.caveats
        if any(each.covers(name, caveat) for each in patterns)
    ]
    if not found:
        return None
    _, worst, text = max(found)
    count = len(distinct({name: runs[name] for _, name, _ in found}))
    return [literal(rule.replace("_", " ")), str(count), literal(f"{worst}: {text}"), why]


FILE = "caveats.yaml"
_Texts = Annotated[list[Annotated[str, Field(min_length=1)]], Field(min_length=1)]


class ExpectedCaveats(StrictModel):
    """Some caveats of some runs that are expected for one reason.

    Attributes:
        rules: Names of the rules that find them.
        runs: Patterns of the names of the runs, such as "figure_5_*/as_reported".
        why: Cause of the caveats, and why the study's conclusions hold nevertheless; a sentence.
    """

    rules: _Texts
    runs: _Texts
    why: Annotated[str, Field(min_length=1)]


def read_expected(folder: Path) -> tuple[ExpectedCaveat, ...]:
    """Return the caveats that a study expects: those of its file, if it has one.

    Raises:
        RunnerError: if the file does not fit, or names a rule that does not exist; with entry and key.
    """
    path = folder / FILE
    if not path.is_file():
        return ()
    entries = read_data(path, list[ExpectedCaveats])
    for rule in (rule for entry in entries for rule in entry.rules):
        if rule not in THRESHOLDS:
            raise RunnerError(
                f"{path}: there is no rule '{rule}'{nearest(rule, THRESHOLDS)}; rules: {', '.join(THRESHOLDS)}"
            )
    return tuple(
        ExpectedCaveat(rule, runs, entry.why) for entry in entries for runs in entry.runs for rule in entry.rules
    )
