"""Failed runs of a sweep, with axis values and reasons, and caveats of its cells."""

import numpy as np
from numpy.typing import NDArray

from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.document import Block, Notice, Section, Table
from runner.reporting.markup import literal, literals
from runner.reporting.sweep.subject import Subject
from runner.store.axes import Axis

_MOST_ROWS = 40


def section(subject: Subject) -> Section:
    """Return the failed runs."""
    measurements = subject.measurements
    failed = np.array([status != "ok" for status in measurements.statuses])
    blocks: list[Block] = []
    if subject.axes:
        rows = [row for axis in subject.axes for row in _by_level(axis, failed)]
        blocks.append(Table("Failed runs by axis.", ["axis", "value", "failed"], [literals(row) for row in rows], (2,)))
    cells = np.flatnonzero(failed).tolist()
    rows = [
        [measurements.hashes[cell][:8], subject.cell_name(cell), measurements.failures[cell]]
        for cell in cells[:_MOST_ROWS]
    ]
    left = len(cells) - len(rows)
    more = f" {left} more stand in the list of runs and in the table of the sweep." if left else ""
    blocks.append(Table(f"Failed runs.{more}", ["run", "cell", "failure"], [literals(row) for row in rows]))
    return Section("Failed runs", blocks)


def _by_level(axis: Axis, failed: NDArray[np.bool_]) -> list[list[str]]:
    """Return how many cells failed at each value of an axis at which any did; of many values some, spread evenly."""
    count, lost = (np.bincount(axis.level[chosen], minlength=len(axis.values)) for chosen in (slice(None), failed))
    levels = np.flatnonzero(lost)
    chosen = levels[spaced_indices(len(levels), _MOST_ROWS)].tolist()
    return [[axis.name, axis.text(level), f"{lost[level]} of {count[level]}"] for level in chosen]


def has_caveats(subject: Subject) -> bool:
    """Tell whether there is something to say."""
    return any(subject.measurements.caveats) or bool(subject.measurements.caveat_changes)


def caveats_section(subject: Subject) -> Section:
    """Return the rules that were sprung, each with its number of cells and the worst one, and where rules differ."""
    measurements = subject.measurements
    cells = len(measurements.hashes)
    blocks: list[Block] = []
    rows = [
        literals([rule, f"{count} of {cells}", subject.cell_name(cell) or "the only one", text])
        for rule, count, cell, text in measurements.caveats_by_rule()
    ]
    if rows:
        caption = "Why results may not be what they seem: rules, cells with that caveat, and the worst of them."
        blocks.append(Table(caption, ["caveat", "cells", "worst cell", "what was found there"], rows, (1,)))
    if measurements.caveat_changes:
        changes = "; ".join(f"{what} ({count} of {cells} cells)" for what, count in measurements.caveat_changes.items())
        text = literal(f"Caveats were looked for by {changes}.")
        blocks.append(Notice("warning", "Caveats by other rules than today's", text))
    return Section("Caveats", blocks)
