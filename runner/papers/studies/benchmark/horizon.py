"""Sensitivity of the benchmark's result to later rounds, another speed and less tuning."""

import numpy as np

from runner.papers.studies.benchmark.cells import ROUND, BenchmarkCell
from runner.papers.studies.benchmark.figures import answer, any_origin, error_words
from runner.papers.studies.benchmark.made import ARMS, CHANGES, CONDITIONS, LATER, all_cells, arms_of, turned
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs
from runner.reporting.document import Table
from runner.reporting.words import in_words

_FIRST_TUNING = ("1",)


def settled(runs: Runs, condition: str) -> Measured:
    """Return on how many arms the order of the first three laws stays to the last round, under a condition."""
    stays = sum(not turned(runs, arm, condition) for arm in arms_of(runs))
    return Measured(f"arms on which the order stays, {CONDITIONS[condition]}", float(stays))


def passed_by(runs: Runs, condition: str, law: str) -> Measured:
    """Return on how many arms a law is the first to pass one of the first three in a later round."""
    passes = sum(turned(runs, arm, condition).startswith(f"{in_words(law)} passes ") for arm in arms_of(runs))
    return Measured(f"arms on which {in_words(law)} passes another law, {CONDITIONS[condition]}", float(passes))


def rounds(runs: Runs, caption: str) -> Table:
    """Return a table of changes in the order of the first three laws between rounds, conditions by arms."""
    arms = arms_of(runs)
    rows = [
        [CONDITIONS[condition], *(turned(runs, arm, condition) or "stays" for arm in arms)]
        for condition in all_cells(runs, arms[0], "learned")
    ]
    return Table(caption, ["condition", *(ARMS[arm] for arm in arms)], rows, any_origin(runs))


def what_changes(runs: Runs, caption: str) -> Table:
    """Return a table of the leading law with all wrong at once, for the judged case and each single change."""
    arms = arms_of(runs)
    columns = [_column(runs, arm) for arm in arms]
    rows = [
        [words, *(f"{answer(column[words])} ({error_words(column[words].best)})" for column in columns)]
        for words in columns[0]
    ]
    return Table(caption, ["what is otherwise", *(ARMS[arm] for arm in arms)], rows, any_origin(runs))


def grown(runs: Runs, condition: str, *laws: str) -> Measured:
    """Return the largest error in the last round over that in the round that is judged, of some laws, or of any."""
    after = LATER[-1]
    shares = [
        one / other
        for arm in arms_of(runs)
        for entry in all_cells(runs, arm, "learned")[condition].entries
        if not laws or entry.law in laws
        for last in [all_cells(runs, arm, "learned", after=after)[condition].entry(entry.law)]
        for one, other in zip(last.by_tuning.tolist(), entry.by_tuning.tolist(), strict=True)
        if np.isfinite(other)
    ]
    of = ", ".join(map(in_words, laws)) or "any law"
    words = f"error of {of} in round {after} over that in round {ROUND}, {CONDITIONS[condition]}"
    most = max(shares, default=np.inf)
    return Measured(words, most if np.isfinite(most) else None)


def _column(runs: Runs, arm: str) -> dict[str, BenchmarkCell]:
    def of(question: str, after: int = ROUND) -> BenchmarkCell:
        return all_cells(runs, arm, question, _FIRST_TUNING, after=after)["all"]

    changed = all_cells(runs, arm, "changed")
    return {
        f"nothing: round {ROUND}, 2 s a round, 32 trials": of("learned"),
        **{f"round {after}": of("learned", after) for after in LATER},
        "the first 2 s": of("first"),
        **{words: changed[change] for change, words in CHANGES.items() if change in changed},
    }
