"""Axes of a sweep, fixed values and number of failed runs."""

import math

from runner.reporting.document import Block, Notice, Origin, Section, Table, Text
from runner.reporting.markup import literal, literals
from runner.reporting.sweep.subject import Subject, key_label, shorten
from runner.statistics import SMALLEST_SAMPLE

_MOST_VALUES = 12
_MOST_ROWS, _MOST_PLACES = 16, 6  # of the table of what also differs


def section(subject: Subject, command: str) -> Section:
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
        rows.append([key_label(axis.name), str(len(names)), ", ".join(shown)])
    blocks: list[Block] = []
    cells = len(measurements.hashes)
    if rows:
        blocks.append(Table("Swept axes.", ["axis", "number", "values"], [literals(row) for row in rows], (1,), origin))
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
                "They stand in the figures as crosses and in a section of their own. A failed repetition counts as "
                "beyond every number, as one does that never settles.",
            )
        )
    if measurements.repetitions < SMALLEST_SAMPLE:
        blocks.append(
            Notice(
                "warning",
                f"Too few repetitions for intervals: {measurements.repetitions} of {SMALLEST_SAMPLE}",
                "Of so few values even the whole range may miss the true median in more than 5 of 100 cases. Cells "
                f"are compared by their medians alone; repetitions={SMALLEST_SAMPLE} or more gives intervals.",
            )
        )
    return Section("Axes", blocks)


def _also_differs(subject: Subject) -> list[Block]:
    """Return the table of config values that are not the same in all cells, though nobody swept them."""
    rows = []
    for difference in subject.measurements.differences[:_MOST_ROWS]:
        values = [f"{levels}: {shorten(text)}" if levels else shorten(text) for levels, text in difference.values]
        shown = values if len(values) <= _MOST_PLACES else [*values[: _MOST_PLACES - 2], "...", values[-1]]
        label = key_label(difference.key)
        rows.append([label, ", ".join(difference.axes) or "none", "; ".join(shown)])
    left = [difference.key for difference in subject.measurements.differences[_MOST_ROWS:]]
    if not rows:
        return []
    more = literal(f" {len(left)} more: {', '.join(left)}.") if left else ""
    caption = (
        "Also differs: config values that are not the same in all cells, though they were not swept. What an axis "
        f"seems to do may be done by what goes with it.{more}"
    )
    return [Table(caption, ["key", "goes with", "values"], [literals(row) for row in rows])]
