"""The runs that failed: where on the axes, when and why."""

import numpy as np

from runner.reporting.document import Block, Section, Table
from runner.reporting.markup import literals
from runner.reporting.sweep.subject import Subject, value_name

_MOST_ROWS = 40


def section(subject: Subject) -> Section:
    """Return the failed runs."""
    measurements = subject.measurements
    failed = np.array([status != "ok" for status in measurements.statuses])
    blocks: list[Block] = []
    if subject.axes:
        rows = [
            [
                axis.name,
                value_name(axis, level),
                f"{failed[axis.level == level].sum()} of {(axis.level == level).sum()}",
            ]
            for axis in subject.axes
            for level in range(len(axis.values))
            if failed[axis.level == level].any()
        ]
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
