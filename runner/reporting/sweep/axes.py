"""What was swept: axes, what stood fixed, and how many runs failed."""

import math

from runner.reporting.document import Block, Notice, Origin, Section, Table, Text
from runner.reporting.sweep.subject import Subject, axis_label, value_names
from runner.statistics import SMALLEST_SAMPLE

_MOST_VALUES = 12


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
        names = value_names(axis)
        shown = names if len(names) <= _MOST_VALUES else [*names[: _MOST_VALUES - 2], "...", names[-1]]
        rows.append([axis_label(axis), str(len(names)), ", ".join(shown)])
    blocks: list[Block] = []
    cells = len(measurements.hashes)
    if rows:
        blocks.append(Table("Swept axes.", ["axis", "number", "values"], [_literal(row) for row in rows], (1,), origin))
    grid = math.prod(len(axis.values) for axis in subject.axes)
    whole = "every combination of their values" if grid == cells else f"not all of the {grid} combinations"
    fixed = ", ".join(measurements.fixed)
    blocks.append(
        Text(
            f"{cells} cells, {whole}; repetitions in a cell: {measurements.repetitions}. "
            + (f"The same in all: {fixed}." if fixed else "").replace("$", "$$")
        )
    )
    failed = sum(status != "ok" for status in measurements.statuses)
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


def _literal(cells: list[str]) -> list[str]:
    return [cell.replace("$", "$$") for cell in cells]
