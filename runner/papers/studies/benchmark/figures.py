"""Tables, maps and numbers of the benchmark over arms, controllers and conditions."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number, quantity
from runner.papers.studies.benchmark.cells import ROUND, UNTUNED, BenchmarkCell, LawInCell, Lead, tuned
from runner.papers.studies.benchmark.made import (
    ARMS,
    CONDITIONS,
    QUESTIONS,
    all_cells,
    arms_of,
    laws_of,
    one_cell,
    turned,
)
from runner.papers.study.measured import Measured
from runner.papers.study.prose.signals import Quantity
from runner.papers.study.results import Runs, matching_runs
from runner.reporting.charts.figure import Map, Panel, Series
from runner.reporting.document import Curves, Maps, Origin, Table, Text
from runner.reporting.figures import origin
from runner.reporting.table import numbers
from runner.reporting.words import in_words
from runner.store import Run

_IN_A_TABLE = 4  # arms
_NAMED = 5  # tied laws that are named
_FAR = 1.1  # ratio of errors that three digits distinguish from one


def best_laws(runs: Runs, question: str, caption: str) -> list[Table]:
    """Return the laws that none is shown to be ahead of, on each arm under each condition, and who is next.

    Args:
        runs: The runs of the study.
        question: One of QUESTIONS.
        caption: What is seen.
    """
    arms = arms_of(runs)
    made = {arm: all_cells(runs, arm, question) for arm in arms}
    tables = []
    for start in range(0, len(arms), _IN_A_TABLE):
        some = arms[start : start + _IN_A_TABLE]
        rows = [[CONDITIONS[name], *(said(runs, arm, question, name) for arm in some)] for name in made[some[0]]]
        tables.append(Table(caption, ["condition", *(ARMS[arm] for arm in some)], rows, any_origin(runs)))
    return tables


def behind_the_best(runs: Runs, question: str, caption: str) -> Maps:
    """Return the error of every law over the smallest one as maps, an arm each; runs that failed are marked."""

    def behind(arm: str, law: str, condition: str) -> tuple[float, bool]:
        cell = all_cells(runs, arm, question)[condition]
        entry = cell.entry(law)
        return ratio(entry, cell.best) or np.nan, entry.failed > 0.0

    return maps_of_laws(runs, caption, "error over the smallest", behind, all_cells(runs, arms_of(runs)[0], question))


def troubles(runs: Runs, question: str, gains: str, caption: str) -> Maps | Text:
    """Return the failed repetitions of each law, in per cent, as one map for each arm; a sentence if none failed.

    Args:
        runs: The runs of the study.
        question: One of QUESTIONS.
        gains: "tuned" or "untuned".
        caption: What is seen.
    """

    def share(arm: str, law: str, condition: str) -> tuple[float, bool]:
        return 100.0 * all_cells(runs, arm, question, _chosen(gains))[condition].entry(law).failed, False

    conditions = all_cells(runs, arms_of(runs)[0], question)
    maps = maps_of_laws(runs, caption, "repetitions that failed (%)", share, conditions)
    if not any(panel.values.any() for panel in maps.panels):
        return Text(f"{caption} Here there are none, of no law on no arm under no condition.")
    return maps


def maps_of_laws(
    runs: Runs,
    caption: str,
    label: str,
    value: Callable[[str, str, str], tuple[float, bool]],
    conditions: Iterable[str],
) -> Maps:
    """Return a number of each law under each condition as maps, an arm each.

    Args:
        runs: The runs of the study.
        caption: What is seen.
        label: The number, with its unit; with "over" in it, the scale is logarithmic.
        value: Gives the number of an arm, law and condition, and whether its cell is marked.
        conditions: The conditions.
    """
    names, panels = [*conditions], []
    for arm in arms_of(runs):
        laws = laws_of(runs, arm)[::-1]
        values, marked = np.moveaxis(np.array([[value(arm, law, name) for name in names] for law in laws]), 2, 0)
        shown, words = np.where(np.isfinite(values), values, np.nan), [CONDITIONS[name] for name in names]
        panels.append(Map(ARMS[arm], "", "", words, list(map(in_words, laws)), shown, marked.astype(bool)))
    return Maps(caption, label, panels, " over " in label, 1, any_origin(runs))


def error_against(runs: Runs, metric: str, label: str, condition: str, caption: str) -> Curves:
    """Return the error of each law in the first round against what another metric says of its torques, by arm.

    Args:
        runs: The runs of the study.
        metric: The metric, such as "torque_chatter".
        label: Its axis, with unit.
        condition: The condition.
        caption: What is seen.
    """
    panels = []
    for arm in arms_of(runs):
        cell, series = all_cells(runs, arm)[condition], []
        for index, law in enumerate(laws_of(runs, arm)):
            entry = cell.entry(law)
            used = [typical(runs, arm, law, condition, own, metric) for own in tuned(runs)]
            series.append(Series(in_words(law), np.array(used), entry.by_tuning, "points", color=index))
        panels.append(Panel(ARMS[arm], label, "error (m)", series, y_log=True))
    return Curves(caption, panels, 2, any_origin(runs))


def spread(runs: Runs, question: str, caption: str) -> Table:
    """Return a table of the spread of errors over tunings, by law and arm, with all wrong at once."""
    arms = arms_of(runs)
    rows = []
    for law in laws_of(runs, arms[0]):
        found_on = [all_cells(runs, arm, question)["all"].entry(law).by_tuning for arm in arms]
        rows.append([in_words(law), *(_apart(own) for own in found_on)])
    return Table(caption, ["law", *numbers(*(ARMS[arm] for arm in arms))], rows, any_origin(runs))


def error(law: str, condition: str, question: str = "first", gains: str = "tuned") -> Quantity:
    """Return the error of a law under a condition, a quantity of an arm, in m; None where it failed."""
    return Quantity(lambda runs, arm: _finite(one_cell(runs, arm, condition, question, _chosen(gains)).entry(law)))


def lead(law: str, other: str, condition: str, question: str) -> Quantity:
    """Return the lower end of the interval of another law's error over that of a law; None where it does not lead."""

    def low(runs: Runs, arm: str) -> float | None:
        given = one_cell(runs, arm, condition, question).leads.get((law, other))
        return None if given is None or not given.shown or given.interval is None else given.interval[0]

    return Quantity(low)


def on_arms(runs: Runs, words: str, what: Callable[[Runs, str], float | None], *arms: str) -> list[Measured]:
    """Return a quantity of some arms, of all where none is named."""
    return [Measured(f"{words}, {ARMS[arm]}", what(runs, arm)) for arm in arms or arms_of(runs)]


def in_front(runs: Runs, question: str, condition: str, law: str) -> Measured:
    """Return on how many arms no law is shown to be ahead of a law."""
    there = sum(law in one_cell(runs, arm, condition, question).groups[0] for arm in arms_of(runs))
    asked = f"{CONDITIONS[condition]}, {QUESTIONS[question]}"
    return Measured(f"arms on which none is ahead of {in_words(law)}, {asked}", float(there))


def failed(runs: Runs, gains: str, condition: str, *arms: str) -> list[Measured]:
    """Return the failed repetitions of each law under a condition on some arms, or all, in per cent."""
    return [
        Measured(f"repetitions of {in_words(each.law)} that failed, {gains}, {ARMS[arm]}", 100.0 * each.failed, "%")
        for arm in arms or arms_of(runs)
        for each in one_cell(runs, arm, condition, gains=_chosen(gains)).entries
    ]


def ratio(one: LawInCell, other: LawInCell) -> float | None:
    """Return the error of a law over that of another one; None where both or the other one failed."""
    return one.score / other.score if np.isfinite(other.score) else None


def _finite(entry: LawInCell) -> float | None:
    return entry.score if np.isfinite(entry.score) else None


def error_words(entry: LawInCell) -> str:
    """Return the error of a law, and the fraction of its repetitions that failed."""
    if entry.failed == 0.0:
        return quantity(entry.score, "m")
    failed = f"{number(100.0 * entry.failed, 2)} % failed"
    return f"{quantity(entry.score, 'm')}, {failed}" if np.isfinite(entry.score) else failed


def lead_words(lead: Lead) -> str:
    """Return the lead of a law as text, with its interval if seeds are drawn."""
    digits = 3 if lead.factor > _FAR else 4
    factor, *ends = (number(value, digits, zeros=True) for value in (lead.factor, *(lead.interval or ())))
    return f"{factor} times ({' to '.join(ends)})" if ends else f"{factor} times"


def _chosen(gains: str) -> Sequence[str]:
    return () if gains == "tuned" else UNTUNED


def any_origin(runs: Runs) -> Origin:
    """Return the origin of a table over several arms: the command of the first run."""
    return origin(next(iter(runs.values())))


def said(runs: Runs, arm: str, question: str, condition: str) -> str:
    """Return the answer to a question on an arm; where a later round changes it, that it does."""
    cell = all_cells(runs, arm, question)[condition]
    passed = turned(runs, arm, condition) if question == "learned" else ""
    if not passed:
        return answer(cell)
    return f"no answer: in round {ROUND} {', '.join(map(in_words, cell.groups[0]))}; {passed}"


def answer(cell: BenchmarkCell) -> str:
    """Return the laws of the first group as text; if it holds one law, also its lead."""
    if not np.isfinite(cell.best.score):
        return "all failed"
    first = cell.groups[0]
    if len(first) > _NAMED:
        return f"{in_words(first[0])}; tied with {len(first) - 1} others"
    if len(first) > 1:
        return f"{in_words(first[0])}; tied with {', '.join(map(in_words, first[1:]))}"
    lead = cell.leads[cell.best.law, cell.entries[1].law]
    return f"{in_words(cell.best.law)}, {lead_words(lead)} ahead of {in_words(lead.other)}"


def _apart(errors: FloatArray) -> str:
    return number(float(errors.max() / errors.min()), zeros=True) if np.isfinite(errors).all() else "failed"


def typical(runs: Runs, arm: str, law: str, condition: str, gains: str, metric: str) -> float:
    """Return the mean over the paths of the median of a metric; NaN where a run has none."""
    own = [one.run for one in matching_runs(runs, f"first/{arm}/{law}/{{task}}/{condition}/{gains}")]
    return float(np.mean([_median(run, metric) for run in own]))


def _median(run: Run, metric: str) -> float:
    median = run.metrics[metric].median if metric in run.metrics else None
    return np.nan if median is None else float(median)


def leads_confirmed(runs: Runs) -> Measured:
    """Return of the leads that one half shows the share that the other half shows, too, in per cent."""
    said, again, _ = halves(runs)
    return Measured("leads that the other half shows, too", 100.0 * again / said if said else None, "%")


def leads_reversed(runs: Runs) -> Measured:
    """Return the number of leads of one half that the other half shows reversed."""
    return Measured("leads that the other half turns round", float(halves(runs)[2]))


def halves(runs: Runs) -> tuple[int, int, int]:
    """Return the numbers of drawn leads: in both halves together, confirmed and reversed by the other half.

    They are those of the first question, which has seeds enough for two halves.
    """
    a, b = (_shown(runs, slice(start, None, 2)) for start in (0, 1))
    turned = {(arm, name, (behind, law)) for arm, name, (law, behind) in a} & b
    return len(a) + len(b), 2 * len(a & b), 2 * len(turned)


def _shown(runs: Runs, seeds: slice) -> set[tuple[str, str, tuple[str, str]]]:
    return {
        (arm, name, key)
        for arm in arms_of(runs)
        for name, cell in all_cells(runs, arm, seeds=seeds).items()
        for key, lead in cell.leads.items()
        if lead.shown and lead.p_value is not None
    }
