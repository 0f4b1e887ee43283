"""Pareto front of two metrics over the cells of a sweep."""

from collections.abc import Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.reporting.charts.figure import POINTS, spaced_indices
from runner.reporting.document import Curves, Panel, ReportBlock, Section, Series, Table, Text
from runner.reporting.metric_titles import COSTS, title
from runner.reporting.sweep.subject import Subject, spans_decades
from runner.reporting.table import numbers
from runner.sweeps.question import is_condition

_MOST_ROWS = 12


def pair(subject: Subject) -> tuple[str, str] | None:
    """Return the two metrics that are traded off: the first of the report, and what it costs, or its second.

    None if an axis is a condition, such as the noise: no designer chooses it, so that a front over it says nothing.
    """
    if any(is_condition(axis.name) for axis in subject.axes):
        return None
    first, rest = subject.metrics[0], subject.metrics[1:]
    costs = [name for name in COSTS if name in rest]
    found = [name for name in (*costs, *rest) if np.unique(_finite(subject.medians[name])).size > 1]
    return (first, found[0]) if found and np.isfinite(subject.medians[first]).any() else None


def front(a: FloatArray, b: FloatArray) -> list[int]:
    """Return the indices of the points that no other point beats in one coordinate without losing in the other.

    Args:
        a: First coordinates, shape (n,); less is better, and what is not finite is on no front.
        b: Second coordinates, shape (n,).

    Returns:
        The front, by ascending first coordinate.
    """
    best = np.inf
    chosen = []
    for index in np.lexsort((b, a)).tolist():
        if np.isfinite(a[index]) and b[index] < best:
            best = b[index]
            chosen.append(index)
    return chosen


def section(subject: Subject, metrics: tuple[str, str]) -> Section:
    """Return the trade-off between two metrics."""
    a, b = (subject.medians[metric] for metric in metrics)
    best = front(a, b)
    present = np.flatnonzero(np.isfinite(a) & np.isfinite(b)).tolist()
    shown = [present[place] for place in spaced_indices(len(present), POINTS)]
    panel = Panel(
        "",
        subject.label(metrics[0]),
        subject.label(metrics[1]),
        [
            Series("cells", a[shown], b[shown], "points", hints=subject.hints(shown), runs=subject.hashes(shown)),
            Series("front", a[best], b[best], "points_line", hints=subject.hints(best), runs=subject.hashes(best)),
        ],
        spans_decades(a),
        spans_decades(b),
    )
    text = f"The front has {len(best)} of {len(present)} cells: along it one median falls and the other grows. No test."
    if len(best) == 1:
        text = "One cell has the lowest median of both. No test."
    blocks: list[ReportBlock] = [
        Text(text),
        Curves(
            f"Pareto front of {title(metrics[0])} and {title(metrics[1])}, medians of each cell.", [panel], columns=1
        ),
        _table(subject, metrics, best),
    ]
    return Section("Trade-off", blocks)


def _table(subject: Subject, metrics: tuple[str, str], best: Sequence[int]) -> Table:
    # Of a long front, cells along the whole of it.
    chosen = [best[index] for index in spaced_indices(len(best), _MOST_ROWS)]
    units = subject.measurements.units
    rows = [
        [
            subject.cell_name(cell),
            *(quantity(float(subject.medians[name][cell]), units[name]) for name in metrics),
        ]
        for cell in chosen
    ]
    return Table("Cells on the front.", ["cell", *numbers(*map(title, metrics))], rows)


def _finite(values: FloatArray) -> FloatArray:
    return values[np.isfinite(values)]
