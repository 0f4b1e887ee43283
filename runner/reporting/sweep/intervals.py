"""Medians with confidence intervals over one or two axes of a sweep."""

from dataclasses import replace

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.charts.map_scale import EQUAL, widen_range
from runner.reporting.document import Curves, Panel, Series
from runner.reporting.sweep.subject import Subject, axis_label, spans_decades, value_names
from runner.sweeps.measurements import Axis

_MOST_LINES = 6
_APART = 0.1  # of curves at one text, so that their bars are seen
_MOST_INTERVALS = 60


def cells_with_intervals(subject: Subject, metric: str) -> Curves | None:
    """Return the median of each cell over one axis, a curve for each value of the other axis if there are two.

    Returns:
        The figure, or None where there are more curves or cells than a reader can tell apart.
    """
    # Along the axis with more values, and rather along numbers than along texts.
    along, *other = sorted(subject.axes, key=lambda axis: (axis.numbers is None, -len(axis.values)))
    groups = other[0].level if other else np.zeros(len(subject.measurements.hashes), dtype=np.intp)
    count = len(other[0].values) if other else 1
    if count > _MOST_LINES or count * len(along.values) > _MOST_INTERVALS:
        return None
    low, high = subject.ends(metric)
    values, curves = (low, subject.medians[metric], high), []
    for group in range(count):
        cells = np.flatnonzero(groups == group)
        cells = cells[np.argsort(along.level[cells], kind="stable")].tolist()
        low, median, high = (np.where(np.isfinite(each), each, np.nan)[cells] for each in values)
        name = f"{other[0].name} = {other[0].text(group)}" if other else ""
        x = places(along)[along.level[cells]]
        hints, runs = subject.hints(cells), subject.hashes(cells)
        curve = Series(name, x, median, "points_line", low, high, group, hints, runs)
        beside = _APART * (group - (count - 1) / 2)
        curves += [curve] if along.numbers is not None else at_texts(replace(curve, x=x + beside))
    panel = axis_panel("", along, subject.label(metric), curves, np.concatenate([series.y for series in curves]))
    sizes = sorted({subject.measurements.of_cell(metric, cell).size for cell in range(len(groups))})
    n = f"n = {sizes[0]}" if len(sizes) == 1 else f"n = {sizes[0]} to {sizes[-1]}"
    interval = f"its 95 % interval by the bootstrap over the repetitions ({n}), if enough"
    caption = f"Median of each cell; shaded, or a bar, {interval}."
    return Curves(caption, [panel], columns=1)


def at_texts(series: Series) -> list[Series]:
    """Return a curve over texts as points with upright bars: between texts there is nothing that a line stands for."""
    if series.low is None or series.high is None:
        return [replace(series, style="points")]
    gap = np.full(series.x.size, np.nan)
    bars = Series(
        "", np.repeat(series.x, 3), np.column_stack([series.low, series.high, gap]).ravel(), color=series.color
    )
    return [bars, replace(series, style="points", low=None, high=None)]


def places(axis: Axis) -> FloatArray:
    """Return where the values of an axis stand: at their numbers, or at 0, 1, ... where they are texts."""
    return np.arange(len(axis.values), dtype=float) if axis.numbers is None else axis.numbers


def axis_panel(title: str, axis: Axis, y_label: str, series: list[Series], y: FloatArray) -> Panel:
    """Return a panel over one axis of the sweep, logarithmic where its values, or the ordinates, span decades."""
    names = value_names(axis) if axis.numbers is None else ()
    x_log = axis.numbers is not None and spans_decades(axis.numbers)
    edges = [edge for each in series for edge in (each.y, each.low, each.high) if edge is not None]
    drawn = np.concatenate([edge[np.isfinite(edge)] for edge in edges])
    least = EQUAL * float(np.abs(drawn).max(initial=0.0))
    close = drawn.size and np.ptp(drawn) < least  # such differences are not to fill the panel
    y_range = widen_range(float(drawn.min()), float(drawn.max()), least) if close else None
    return Panel(title, axis_label(axis), y_label, series, x_log, spans_decades(y), y_range=y_range, x_names=names)
