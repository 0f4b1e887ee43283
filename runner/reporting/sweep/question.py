"""Paired comparisons of the values of an axis: the main question of a sweep, and the tables of all axes."""

from collections.abc import Sequence

import numpy as np

from runner.base.errors import RunnerError
from runner.base.quantities import quantity
from runner.base.sanitize import few
from runner.reporting.answers import EXPLAINED, HEADER, Answer, ask, judge, sentences, short_table
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.comparison.difference_figure import difference_panel
from runner.reporting.comparison.pairs import SEED, level_pairs
from runner.reporting.comparison.sweeps import compare_levels
from runner.reporting.document import Block, Curves, Section, Table, Text
from runner.reporting.markup import literal
from runner.reporting.metric_titles import capital, first_screen, title
from runner.reporting.sweep.subject import Subject, key_label
from runner.reporting.table import numbers
from runner.statistics import SMALLEST_SAMPLE
from runner.store.axes import Axis

_MOST_KEYS = 3  # that vary with an axis and are named
_MOST_COLUMNS = 12
_MOST_PAIRS = 24


def find_answers(subject: Subject) -> list[Answer]:
    """Return the answers to what a sweep asks; none where no two cells differ in one axis and share their seed.

    Compared are the values of the first axis whose values are choices, such as controllers, else of the first one.
    """
    axis = asked_axis(subject)
    if axis is None or not subject.metrics or too_few(subject):
        return []
    try:
        return compare_levels(subject.measurements, axis.name, None, subject.metrics)
    except RunnerError:
        return []


def asked_axis(subject: Subject) -> Axis | None:
    """Return the axis that a sweep asks about."""
    axes = [axis for axis in subject.axes if axis.name != SEED]
    return min(axes, key=lambda axis: axis.numbers is not None, default=None)


def answer_blocks(answers: Sequence[Answer]) -> list[Block]:
    """Return the figure of paired differences and the short table."""
    caption = "Medians and difference of each metric, and whether the difference is shown."
    return [_figure(answers), Table(caption, *short_table(answers))]


def _figure(answers: Sequence[Answer]) -> Curves:
    """Return the paired differences in the metrics of the first screen, at each level or of each compared value."""
    overall = [one for one in answers if not one.at]
    several = len({one.names for one in overall}) > 1
    panels = []
    for metric in first_screen(list(dict.fromkeys(one.metric for one in answers))):
        shown = [one for one in (overall if several else answers) if one.metric == metric]
        names = [one.names[1] if several else ", ".join(one.at.values()) or "all" for one in shown]
        kept = spaced_indices(len(shown), _MOST_COLUMNS)
        across = (
            "value compared" if several else ", ".join(map(key_label, next((one.at for one in shown if one.at), {})))
        )
        panels.append(difference_panel([(names[place], shown[place]) for place in kept], across))
    first, second = answers[0].names
    what = f"each minus {first}" if several else f"{second} minus {first}"
    pairs = sorted({one.comparison.n for one in overall})
    n = " to ".join(str(count) for count in dict.fromkeys([pairs[0], pairs[-1]]))
    levels = "" if several or len(answers) == len(overall) else " and at each level"
    caption = (
        f"Differences, {what}, over all {n} pairs{levels}: a dot for each pair; point and bar are the "
        "Hodges-Lehmann estimate and its interval, at the level of the signed-rank test corrected by Holm."
    )
    return Curves(literal(caption), panels)


def causes(subject: Subject, answers: Sequence[Answer]) -> list[str]:
    """Return the other keys that may cause a difference because they vary with the axis."""
    axis = asked_axis(subject)
    along = [found.key for found in subject.measurements.differences if axis is not None and axis.name in found.axes]
    if axis is None or not along or not any(answer.sign for answer in answers):
        return []
    return [f"{few(along, _MOST_KEYS)} vary with {axis.name} and may be the cause: see Also differs."]


def in_short(subject: Subject) -> str:
    """Return the first answer, as a command that made a sweep ends with it; else the range of medians, and why."""
    answers = find_answers(subject)
    if len({one.names for one in answers}) == 1:
        return sentences(answers)[0]
    found = range_told(subject)
    return f"{found[0]}: medians from {found[1]}. {too_few(subject)}".rstrip() if found else ""


def range_told(subject: Subject) -> tuple[str, str] | None:
    """Return the first metric and the range of its medians over the cells, as strings; None if nothing is ranked."""
    if not (subject.ranked and subject.axes):
        return None
    metric = subject.metrics[0]
    ends = [float(subject.medians[metric][cell]) for cell in (subject.ranked[0], subject.ranked[-1])]
    low, high = (quantity(end, subject.measurements.units[metric]) for end in ends)
    return title(metric), f"{low} to {high}"


def too_few(subject: Subject) -> str:
    """Return that a sweep has too few draws for any difference to be shown; empty where it has enough."""
    draws = np.unique(subject.measurements.draws).size
    if draws >= SMALLEST_SAMPLE:
        return ""
    return (
        f"With {draws} pair{'s' if draws > 1 else ''} no difference can be shown: {SMALLEST_SAMPLE} are the fewest, as "
        f"by repetitions={SMALLEST_SAMPLE}."
    )


def pairs_section(subject: Subject) -> Section | None:
    """Return the comparisons of each metric, axis by axis; None where no two cells share their seeds."""
    # Choices, such as controllers, are what is compared most.
    axes = sorted(subject.axes, key=lambda axis: axis.numbers is not None)
    tables: dict[str, list[Block]] = {metric: [] for metric in subject.metrics}
    for axis in axes:
        within = level_pairs(subject.measurements, axis.name)
        overall = level_pairs(subject.measurements, axis.name, ()) if any(pair.at for pair in within) else []
        chosen = [within[place] for place in spaced_indices(len(within), _MOST_PAIRS)]
        fewer = (
            f" ({len(chosen)} of {len(within)} pairs, spread evenly over the sweep)"
            if len(chosen) < len(within)
            else ""
        )
        found = judge(ask([*overall, *chosen], subject.metrics), first_screen(subject.metrics))
        for metric, blocks in tables.items():
            rows = [[one.place, ", ".join(one.names), *one.cells] for one in found if one.metric == metric]
            if rows:
                blocks.append(_table(subject, axis, metric, rows, bool(overall), fewer))
    sections = [Section(capital(title(metric)), blocks) for metric, blocks in tables.items() if blocks]
    if not sections:
        return None
    text = (
        "The cells of a pair differ only in one axis, and in what goes with it (Also differs). "
        f"{EXPLAINED} The option --metrics compares by other metrics."
    )
    return Section("Compared in pairs", [Text(text)], sections)


def _table(
    subject: Subject, axis: Axis, metric: str, rows: Sequence[Sequence[str]], overall: bool, fewer: str
) -> Table:
    within = "over all other axes and within each level of them" if overall else "as the only axis"
    if any(other.name == SEED for other in subject.axes):
        within += ", over all seeds"
    return Table(
        literal(f"{capital(title(metric))} by {axis.name}, {within}{fewer}."),
        ["at", axis.name, *numbers(*HEADER), "the second is"],
        rows,
    )
