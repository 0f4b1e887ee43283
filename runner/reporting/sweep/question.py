"""Paired comparisons of the values of an axis: the main question of a sweep, and the tables of all axes."""

from collections.abc import Sequence

import numpy as np

from runner.base.errors import RunnerError
from runner.base.quantities import format_range, label_with_unit, quantity
from runner.base.sanitize import few
from runner.reporting.answers import EXPLAINED, HEADER, PAIRS, Answer
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.comparison.difference_figure import difference_panel
from runner.reporting.comparison.sweeps import compare_levels
from runner.reporting.document import Curves, Items, ReportBlock, Section, Table, Text
from runner.reporting.markup import literal
from runner.reporting.metric_titles import capital, first_screen, title
from runner.reporting.sentences import sentences, short_table, unanswerable
from runner.reporting.sweep.subject import Subject
from runner.reporting.table import numbers
from runner.statistics import SMALLEST_SAMPLE
from runner.store.axes import Axis, group_cells
from runner.sweeps.differing import unit_of
from runner.sweeps.question import find_question

_CHECKS = {
    "gains": ("controller.natural_frequency", "controller.damping_ratio"),
    "period": ("controller.period",),
    "plant step": ("plant.step",),
    "path": ("trajectory",),
    "torque limits": ("torque_limits",),
    "measured velocity": ("noise.velocity",),
    "model error": ("mismatch",),
    "seed": ("seed",),
}
"""Settings that decide whether a comparison is fair, with their keys."""

_MOST_KEYS = 3  # that vary with an axis and are named
_MOST_COLUMNS = 12
_MOST_PAIRS = 24


def find_answers(subject: Subject) -> list[Answer]:
    """Return the answers to the question of a sweep; none if no two cells differ only in it and share their seed."""
    axis = asked_axis(subject)
    if axis is None or not subject.metrics or too_few(subject):
        return []
    try:
        return compare_levels(subject.measurements, axis.name, None, subject.metrics)
    except RunnerError:
        return []


def asked_axis(subject: Subject) -> Axis | None:
    """Return the axis that a sweep asks about; None if all its axes are conditions."""
    return find_question(subject.axes, subject.measurements.question)


def answer_blocks(answers: Sequence[Answer], texts: Sequence[str] = ()) -> list[ReportBlock]:
    """Return further answers in sentences, the figure of paired differences and the short table with its meaning."""
    caption = f"Each metric is a separate question. {PAIRS if any(one.interval for one in answers) else ''}"
    drawn = [one for one in answers if one.interval and one.is_tested]
    return [
        *([Items([literal(text) for text in texts])] if texts else []),
        *([_figure(drawn)] if drawn else []),
        Table(literal(caption), *short_table(answers, by_condition=not texts)),
    ]


def _figure(answers: Sequence[Answer]) -> Curves:
    """Return the paired differences in the metrics of the first screen, pooled and by condition, or of each pair."""
    several = len({one.names for one in answers}) > 1
    overall = [one for one in answers if not one.at]
    panels = []
    for metric in first_screen(list(dict.fromkeys(one.metric for one in answers))):
        shown = [one for one in ((overall or answers) if several else answers) if one.metric == metric]
        if not shown:
            continue
        names = [" - ".join(reversed(one.names)) if several else ", ".join(one.at.values()) or "all" for one in shown]
        kept = spaced_indices(len(shown), _MOST_COLUMNS)
        levels = next((one.at for one in shown if one.at), {})
        across = "compared" if several else ", ".join(label_with_unit(name, unit_of(name)) for name in levels)
        panels.append(difference_panel([(names[place], shown[place]) for place in kept], across))
    first, second = answers[0].names
    what = "of the second and the first" if several else f"{second} minus {first}"
    caption = f"Differences, {what}: a dot for each pair, a point for their estimate and a bar for its interval."
    return Curves(literal(caption), panels)


def causes(subject: Subject, answers: Sequence[Answer]) -> list[str]:
    """Return the other keys in which the values of the question differ, and which may cause a difference."""
    axis = asked_axis(subject)
    along = [found.key for found in subject.measurements.differences if axis is not None and axis.name in found.axes]
    if axis is None or not along or not answers:
        return []
    verb = "varies" if len(along) == 1 else "vary"
    return [f"{few(along, _MOST_KEYS)} {verb} with {axis.name} and may be the cause: see Also differs."]


def made_equal(subject: Subject) -> str:
    """Return which settings that decide a comparison are the same for all values of the question, as a sentence."""
    axis = asked_axis(subject)
    measured = subject.measurements
    if axis is None or not measured.configs:
        return ""
    others = [other for other in subject.axes if other is not axis]
    groups = [
        np.unique(measured.config_of_cells[cells]) for _, cells in group_cells(others, np.arange(len(axis.level)))
    ]
    same: list[str] = []
    different: list[str] = []
    for what, keys in _CHECKS.items():
        if any(axis.name.startswith(key) for key in keys):
            continue
        values = [measured.resolved(key) for key in keys]
        equal = all(some[place] == some[group[0]] for some in values for group in groups for place in group.tolist())
        (same if equal else different).append(what)
    parts = [f"the same for each value of {axis.name}: {', '.join(same)}"] if same else []
    parts += [f"not the same: {', '.join(different)}"] if different else []
    return f"{capital('; '.join(parts))}." if parts else ""


def in_short(subject: Subject) -> str:
    """Return the first answer, as a command that made a sweep ends with it.

    Without one, return the range of the medians, the number of cells without a median, and why there is no answer.
    """
    answers = find_answers(subject)
    if len({one.names for one in answers}) == 1:
        return sentences(answers)[0]
    found = range_told(subject)
    if not found:
        return ""
    cells, known = len(subject.measurements.hashes), len(subject.ranked)
    has = "has" if cells - known == 1 else "have"
    without = f"; {cells - known} of {cells} cells {has} none" if known < cells else ""
    return f"{found[0]}: median{'' if known == 1 else 's from'} {found[1]}{without}. {too_few(subject)}".rstrip()


def range_told(subject: Subject) -> tuple[str, str] | None:
    """Return the first metric and the range of its medians over the cells, as strings; None if nothing is ranked.

    If only one cell has a median, the range is that median.
    """
    if not (subject.ranked and subject.axes):
        return None
    metric = subject.metrics[0]
    ends = [float(subject.medians[metric][cell]) for cell in (subject.ranked[0], subject.ranked[-1])]
    unit = subject.measurements.units[metric]
    return title(metric), quantity(ends[0], unit) if len(subject.ranked) == 1 else format_range(ends[0], ends[1], unit)


def too_few(subject: Subject) -> str:
    """Return that a sweep has too few draws for any difference to be shown; empty if it has enough or draws nothing."""
    draws = np.unique(subject.measurements.draws).size
    if draws >= SMALLEST_SAMPLE or subject.measurements.copies.any():
        return ""
    return (
        f"With {draws} pair{'s' if draws > 1 else ''} no difference can be shown: {SMALLEST_SAMPLE} are the fewest, as "
        f"by repetitions={SMALLEST_SAMPLE}."
    )


def pairs_section(answers: Sequence[Answer]) -> Section | None:
    """Return every comparison that enough pairs can answer, metric by metric; None if there is none."""
    sections = []
    for metric in dict.fromkeys(one.metric for one in answers):
        found = [one for one in answers if one.metric == metric]
        lost = sum(one.is_lost for one in found)
        kept = [one for one in found if one.is_answerable and not one.is_lost]
        shown = [kept[place] for place in spaced_indices(len(kept), _MOST_PAIRS)]
        fewer = f" ({len(shown)} of {len(kept)}, spread evenly)" if len(shown) < len(kept) else ""
        rows = [[one.place, ", ".join(one.names), *one.cells] for one in shown]
        caption = f"{capital(title(metric))}, pooled where that describes all conditions, and by condition{fewer}."
        header = ["at", "compared", *numbers(*HEADER), "the second is"]
        blocks: list[ReportBlock] = [Table(literal(caption), header, rows)] if rows else []
        if lost:
            blocks.append(Text(f"{lost} comparison{' has' if lost == 1 else 's have'} no value in either."))
        if len(kept) + lost < len(found):
            blocks.append(Text(literal(unanswerable([one for one in found if not one.is_answerable]))))
        sections.append(Section(capital(title(metric)), blocks))
    text = f"The cells of a pair differ only in one axis, and in what goes with it (Also differs). {EXPLAINED}"
    return Section("Compared in pairs", [Text(text)], sections) if sections else None
