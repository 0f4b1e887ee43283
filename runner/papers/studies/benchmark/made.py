"""Benchmark results by arm, controller and condition."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from runner.base.data_file import read_data
from runner.papers.studies.benchmark.cells import ALL_SEEDS, ROUND, BenchmarkCell, cells
from runner.papers.study.results import LeftOutError, Runs, matching_runs
from runner.reporting.words import in_words
from runner.statistics.conclusion import SHARE

_WORDS = read_data(Path(__file__).with_name("words.yaml"), dict[str, dict[str, Any]])
ARMS, QUESTIONS, CONDITIONS, CHANGES, LAWS = (
    _WORDS[group] for group in ("arms", "questions", "conditions", "changes", "laws")
)
"""Words for the levels of each axis, in their order. Of a law: what it does, its model, its friction, repetition."""
LATER = (8, 16)
"""Rounds after which the order of the laws is looked at again."""

_FIRST = 3  # laws whose order is to stay


def all_cells(
    runs: Runs,
    arm: str,
    question: str = "first",
    gains: Sequence[str] = (),
    seeds: slice = ALL_SEEDS,
    after: int = ROUND,
) -> dict[str, BenchmarkCell]:
    """Return each law's results on an arm, by condition, in one order; see cells. `question` is one of QUESTIONS."""
    key = (arm, question, tuple(gains), seeds.start, seeds.step, after)
    kept: dict[object, dict[str, BenchmarkCell]] = runs.derived
    if key not in kept:
        made = cells(runs, arm, question, seeds, gains, after=after)
        kept[key] = {condition: made[condition] for condition in (*CONDITIONS, *CHANGES) if condition in made}
    return kept[key]


def one_cell(runs: Runs, arm: str, condition: str, question: str = "first", gains: Sequence[str] = ()) -> BenchmarkCell:
    """Return the results of the laws on an arm under a condition; see all_cells.

    Raises:
        LeftOutError: if there are no such runs.
    """
    found_there = all_cells(runs, arm, question, gains)
    if condition not in found_there:
        raise LeftOutError(f"{ARMS[arm]}, {CONDITIONS[condition]}")
    return found_there[condition]


def turned(runs: Runs, arm: str, condition: str) -> str:
    """Return a sentence on the first later round in which one of the first three laws is passed; empty if none is.

    One law passes another where it is behind by more than 2 % in the round that is judged, and ahead by more later.
    """
    judged = all_cells(runs, arm, "learned")[condition].entries
    for after in LATER:
        later = {each.law: each.score for each in all_cells(runs, arm, "learned", after=after)[condition].entries}
        for place, one in enumerate(judged[:_FIRST]):
            for other in judged[place + 1 :]:
                was_ahead = one.score < (1.0 - SHARE) * other.score
                if was_ahead and later[other.law] < (1.0 - SHARE) * later[one.law]:
                    return f"{in_words(other.law)} passes {in_words(one.law)} by round {after}"
    return ""


def arms_of(runs: Runs) -> list[str]:
    """Return the arms of the runs, in one order."""
    there = runs.levels("first", "arm")
    return [arm for arm in ARMS if arm in there]


def laws_of(runs: Runs, arm: str) -> list[str]:
    """Return the laws that were run on an arm, in the order of the plan."""
    return list(
        dict.fromkeys(one.levels["law"] for one in matching_runs(runs, f"first/{arm}/{{law}}/{{task}}/exact/untuned"))
    )
