"""Axes of a sweep and fixed values, failed runs with reasons, and caveats of the cells."""

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from runner.base.quantities import label_with_unit, with_powers
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.document import Notice, Origin, ReportBlock, Section, Table, Text
from runner.reporting.markup import literal
from runner.reporting.sweep.subject import Subject, key_label, shorten
from runner.reporting.table import numbers
from runner.statistics import SMALLEST_SAMPLE
from runner.store.axes import Axis

_MOST_VALUES = 12
_MOST_FAILURES = 40
_MOST_ACROSS = 8  # columns of the table of causes
_MOST_ROWS, _MOST_PLACES = 16, 6  # of the table of what also differs


def axes_section(subject: Subject, command: str) -> Section:
    """Return the summary of the axes.

    Args:
        subject: The sweep.
        command: The command that makes it.
    """
    origin = Origin(command=command)
    measurements = subject.measurements
    rows = []
    for axis in subject.axes:
        names = axis.texts
        shown = names if len(names) <= _MOST_VALUES else [*names[: _MOST_VALUES - 2], "...", names[-1]]
        rows.append([key_label(axis), str(len(names)), ", ".join(shown)])
    blocks: list[ReportBlock] = []
    cells = len(measurements.hashes)
    if rows:
        blocks.append(Table("Swept axes.", ["axis", *numbers("number"), "values"], rows, origin))
    blocks += _also_differs(subject)
    grid = math.prod(len(axis.values) for axis in subject.axes)
    whole = "every combination of their values" if grid == cells else f"not all of the {grid} combinations"
    fixed = ", ".join(measurements.fixed)
    blocks.append(
        Text(
            f"{cells} cells, {whole}; repetitions in a cell: {measurements.repetitions}. "
            + (literal(f"The same in all: {fixed}.") if fixed else "")
        )
    )
    failed = measurements.failed
    if failed:
        blocks.append(
            Notice(
                "failure",
                f"{failed} of {cells} runs failed",
                "Crosses mark them in the figures; a separate section lists them. A failed repetition counts as "
                "beyond every number, like one that never settles.",
            )
        )
    if measurements.repetitions < SMALLEST_SAMPLE:
        blocks.append(
            Notice(
                "warning",
                f"Too few repetitions for intervals: {measurements.repetitions} of {SMALLEST_SAMPLE}",
                "Of so few values even the whole range may miss the true median in more than 5 of 100 cases. Cells "
                f"are compared only by their medians; repetitions={SMALLEST_SAMPLE} or more gives intervals.",
            )
        )
    return Section("Axes", blocks)


def _also_differs(subject: Subject) -> list[ReportBlock]:
    """Return the table of config values that are not the same in all cells, though no axis sweeps them."""
    rows = []
    for difference in subject.measurements.differences[:_MOST_ROWS]:
        values = [f"{levels}: {shorten(text)}" if levels else shorten(text) for levels, text in difference.values]
        shown = values if len(values) <= _MOST_PLACES else [*values[: _MOST_PLACES - 2], "...", values[-1]]
        label = label_with_unit(difference.key, difference.unit)
        rows.append([label, ", ".join(difference.axes) or "none", "; ".join(shown)])
    left = [difference.key for difference in subject.measurements.differences[_MOST_ROWS:]]
    if not rows:
        return []
    more = literal(f" {len(left)} more: {', '.join(left)}.") if left else ""
    caption = (
        "Also differs: config values that are not the same in all cells, though they were not swept. What an axis "
        f"seems to do may be done by what goes with it.{more}"
    )
    return [Table(caption, ["key", "goes with", "values"], rows)]


def failures_section(subject: Subject) -> Section:
    """Return the failed runs."""
    measurements = subject.measurements
    failed = np.array([status != "ok" for status in measurements.statuses])
    blocks = _failure_map(subject, failed)
    if subject.axes:
        rows = [row for axis in subject.axes for row in _by_level(axis, failed)]
        blocks.append(Table("Failed runs by axis.", ["axis", "value", *numbers("failed")], rows))
    rows = [
        [measurements.hashes[cell][:8], subject.cell_name(cell), with_powers(measurements.failures[cell])]
        for cell in np.flatnonzero(failed).tolist()
    ]
    blocks.append(failed_table("runs", ["run", "cell", "failure"], rows))
    return Section("Failed runs", blocks)


def _failure_map(subject: Subject, failed: NDArray[np.bool_]) -> list[ReportBlock]:
    """Return the table of causes over the two axes whose levels differ most in their shares of failed cells."""
    axes = [axis for axis in subject.axes if len(axis.values) > 1]
    shares = {axis.name: np.bincount(axis.level, failed) / np.bincount(axis.level) for axis in axes}
    holding = sorted(axes, key=lambda axis: float(np.ptp(shares[axis.name])), reverse=True)[:2]
    if len(holding) < 2:
        return []
    across, down = sorted(holding, key=lambda axis: len(axis.values))
    if len(across.values) > _MOST_ACROSS or len(down.values) > _MOST_FAILURES:
        return []
    causes = np.array([(text.partition(": ")[2] or text).partition(": ")[0] for text in subject.measurements.failures])
    columns = range(len(across.values))
    rows = [
        [down.text(row), *(_causes(causes[(down.level == row) & (across.level == column)]) for column in columns)]
        for row in range(len(down.values))
    ]
    header = [key_label(down), *(f"{across.name}={text}" for text in across.texts)]
    caption = literal(f"Causes of failure by {down.name} and {across.name}; none: every run finished.")
    return [Table(caption, header, rows)]


def _causes(causes: NDArray[np.str_]) -> str:
    """Return the causes of failure of some cells, with the share of failed ones unless all failed."""
    lost = [str(cause) for cause in causes if cause]
    if not lost:
        return "none" if len(causes) else "–"
    names = ", ".join(dict.fromkeys(lost))
    return names if len(lost) == len(causes) else f"{names} ({len(lost)} of {len(causes)})"


def failed_table(what: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """Return the table of failed runs or trials; of many the first ones."""
    left = len(rows) - _MOST_FAILURES
    more = f" {left} more are in the list of runs and in the table of the sweep." if left > 0 else ""
    return Table(f"Failed {what}.{more}", header, rows[:_MOST_FAILURES])


def failing_cells(subject: Subject) -> str:
    """Return the shortest condition of one axis or two that all failed cells meet, or the finished ones; else ""."""
    failed = np.array([status != "ok" for status in subject.measurements.statuses])
    told, only = _condition(subject.axes, failed)
    if told:
        return f"Every run with {told} failed, and no other." if only else f"All failed runs have {told}."
    told, only = _condition(subject.axes, ~failed)
    return f"Every run with {told} finished, and no other." if only else ""


def _condition(axes: Sequence[Axis], chosen: NDArray[np.bool_]) -> tuple[str, bool]:
    """Return the shortest condition that some cells meet, or "", and whether no other cell meets it."""
    parts = [
        {axis.name: np.unique(axis.level[chosen]) for axis in some}
        for some in (*combinations(axes, 1), *combinations(axes, 2))
    ]
    by_name = {axis.name: axis for axis in axes}
    best = ""
    for part in parts:
        if any(len(levels) in (0, len(by_name[name].values)) for name, levels in part.items()):
            continue
        inside = np.all([np.isin(by_name[name].level, levels) for name, levels in part.items()], axis=0)
        told = " and ".join(f"{name} {_levels(by_name[name], levels)}" for name, levels in part.items())
        if np.array_equal(inside, chosen):
            return told, True
        best = best or told
    return best, False


def nothing_differs(subject: Subject) -> str:
    """Return a sentence if there is one cell, or if every metric has equal values in all cells; else ""."""
    measured = subject.measurements
    if len(measured.hashes) == 1:
        return "One cell: nothing to compare."
    if measured.failed or not all(np.array_equal(v, v[:1].repeat(len(v), 0), True) for v in measured.values.values()):
        return ""
    return f"All {len(measured.hashes)} cells have equal values of every metric."


def _levels(axis: Axis, levels: NDArray[np.intp]) -> str:
    """Return a phrase for some levels of an axis: numbers at one end as a bound."""
    texts = [axis.text(level) for level in levels.tolist()]
    if axis.numbers is not None and len(texts) > 1:
        chosen, others = axis.numbers[levels], np.delete(axis.numbers, levels)
        if chosen.min() > others.max():
            return f"{axis.text(int(levels[chosen.argmin()]))} or more"
        if chosen.max() < others.min():
            return f"{axis.text(int(levels[chosen.argmax()]))} or less"
    return " or ".join([", ".join(texts[:-1]), texts[-1]]) if len(texts) > 1 else texts[0]


def _by_level(axis: Axis, failed: NDArray[np.bool_]) -> list[list[str]]:
    """Return the number of failed cells at each value of an axis that has any; of many values some, spread evenly."""
    count, lost = (np.bincount(axis.level[chosen], minlength=len(axis.values)) for chosen in (slice(None), failed))
    levels = np.flatnonzero(lost)
    chosen = levels[spaced_indices(len(levels), _MOST_FAILURES)].tolist()
    return [[axis.name, axis.text(level), f"{lost[level]} of {count[level]}"] for level in chosen]


def caveats_section(subject: Subject) -> Section | None:
    """Return the section on rules that found something, each with its worst cell, and on changes of rules; or None."""
    measurements = subject.measurements
    cells = len(measurements.hashes)
    blocks: list[ReportBlock] = []
    rows = [
        [rule, f"{count} of {cells}", subject.cell_name(cell) or "the only one", text]
        for rule, count, cell, text in measurements.caveats_by_rule()
    ]
    if rows:
        caption = "Why results may not be what they seem: rules, cells with that caveat, and the worst of them."
        blocks.append(Table(caption, ["caveat", *numbers("cells"), "worst cell", "what was found there"], rows))
    if measurements.caveat_changes:
        changes = "; ".join(f"{what} ({count} of {cells} cells)" for what, count in measurements.caveat_changes.items())
        text = literal(f"Caveats were looked for by {changes}.")
        blocks.append(Notice("warning", "Caveats by other rules than today's", text))
    return Section("Caveats", blocks) if blocks else None
