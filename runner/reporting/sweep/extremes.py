"""Cells with the lowest and the highest median, and their motion."""

from collections.abc import Sequence

import numpy as np

from runner.base.errors import StoreError
from runner.base.quantities import with_ends
from runner.reporting.document import Block, Notice, Section, Table
from runner.reporting.figures import playback, torque_and_error
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import Subject
from runner.statistics import median_interval
from runner.store import Run


def section(subject: Subject, low: Run, high: Run) -> Section:
    """Return the cells with the lowest and the highest median of the first metric, and their motion.

    Args:
        subject: The sweep, with at least one ranked cell.
        low: Run of the first ranked cell.
        high: Run of the last ranked cell.
    """
    ranked = subject.ranked
    ends = [ranked[0], ranked[-1]] if len(ranked) > 1 else [ranked[0]]
    sections = [_motion(f"Lowest: {subject.cell_name(ranked[0])}", low)]
    if len(ranked) > 1:
        sections.append(_motion(f"Highest: {subject.cell_name(ranked[-1])}", high))
    return Section("Lowest and highest median", (_medians(subject, ends),), sections)


def _medians(subject: Subject, cells: Sequence[int]) -> Table:
    rows = []
    for name in subject.metrics:
        unit = subject.measurements.units[name]
        rows.append(
            [
                literal(title(name)),
                *(_with_interval(subject.measurements.of_cell(name, cell), unit) for cell in cells),
            ]
        )
    header = ["metric", *(literal(subject.cell_name(cell)) for cell in cells)]
    return Table(
        literal(
            f"The cells with the lowest and the highest {title(subject.metrics[0])}: medians, in brackets their 95 % "
            "intervals by the bootstrap over n repetitions. Compared in pairs says which differences are shown."
        ),
        header,
        rows,
        tuple(range(1, len(header))),
    )


def _with_interval(values: np.ndarray, unit: str) -> str:
    if not values.size:
        return "–"
    interval = median_interval(values)
    text, ends, _ = with_ends(interval.median, interval.low, interval.high, unit)
    return f"{text} (n = {interval.n})" if interval.low is None else f"{text} ({ends}, n = {interval.n})"


def _motion(title: str, run: Run) -> Section:
    try:
        blocks: list[Block] = [
            torque_and_error(run, "Torque of each joint and tip position error, repetition 0."),
            playback(run, "The motion of repetition 0."),
        ]
    except StoreError as error:
        blocks = [Notice("warning", "No motion to show", literal(str(error)))]
    return Section(title, blocks)
