"""Distributions of a metric, and the cells with the lowest and the highest median."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import StoreError
from runner.base.quantities import format_range, quantity, with_ends
from runner.reporting.charts.figure import POINTS, spaced_indices
from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import overlaid, playback, torque_and_error
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.sweep.subject import QUANTILE_RULE, Subject, group_levels, spans_decades
from runner.reporting.table import numbers
from runner.statistics import median_interval
from runner.store import Run
from runner.store.axes import Axis
from runner.sweeps.question import find_question, is_condition

_MOST_LINES = 8


def section(subject: Subject) -> Section:
    """Return the distributions of the first metric."""
    metric = subject.metrics[0]
    panels = [_shares(subject, metric, axis) for axis in subject.axes]
    blocks: list[Block] = []
    if panels:
        caption = (
            f"Share of all repetitions in which the {title(metric)} is at most the value below, by axis; a curve that "
            "ends below 1 leaves repetitions that failed or never settled."
        )
        blocks.append(Curves(caption, panels, columns=min(2, len(panels))))
    if not any(is_condition(axis.name) for axis in subject.axes):
        blocks.append(_in_order(subject, metric))
    return Section("Distributions", blocks)


def over_seeds(subject: Subject) -> Section:
    """Return the distribution of each compared metric over all draws of a sweep over only the seed."""
    panels, rows = [], []
    for metric in subject.metrics:
        values = _drawn(subject, metric)
        x, y = _distribution(values)
        panels.append(
            Panel(
                "",
                subject.label(metric),
                "share of draws",
                [Series("", x, y)],
                x_log=spans_decades(values),
                y_range=(0, 1.02),
            )
        )
        low, high = np.quantile(values, (0.05, 0.95), method="inverted_cdf") if values.size else (np.nan, np.nan)
        unit = subject.measurements.units[metric]
        rows.append([title(metric), _with_interval(values, unit), format_range(float(low), float(high), unit)])
    caption = (
        "Medians over the draws, in brackets their 95 % intervals by the bootstrap; and the range from the 5 % to the "
        "95 % quantile."
    )
    drawn = (
        "Share of all draws of all seeds in which a metric is at most the value below; a draw that failed is left out."
    )
    return Section(
        "Distribution over the seeds",
        (
            Curves(drawn, panels, columns=min(2, len(panels))),
            Table(f"{caption} {QUANTILE_RULE}", ["metric", *numbers("median", "5 % to 95 %")], rows),
        ),
    )


def told_over_seeds(subject: Subject) -> str:
    """Return the median of the first metric over all draws of a sweep over only the seed, with their range."""
    metric = subject.metrics[0]
    values = _drawn(subject, metric)
    unit = subject.measurements.units[metric]
    ends = format_range(float(values.min()), float(values.max()), unit)
    middle = quantity(float(np.median(values)), unit)
    return f"Over {values.size} draws the median of the {title(metric)} is {middle}, and all are from {ends}."


def _drawn(subject: Subject, metric: str) -> FloatArray:
    """Return a metric of all draws of all cells, shape (N,), without those that failed."""
    values = subject.measurements.values[metric].ravel()
    return values[~np.isnan(values)]


def _shares(subject: Subject, metric: str, axis: Axis) -> Panel:
    values = subject.measurements.values[metric]
    groups = group_levels(axis)
    series = []
    for group in spaced_indices(int(groups.max()) + 1, _MOST_LINES):
        chosen = groups == group
        pooled = values[chosen]
        x, y = _distribution(pooled[~np.isnan(pooled)])
        first, last = int(axis.level[chosen].min()), int(axis.level[chosen].max())
        name = axis.text(first) + (f" to {axis.text(last)}" if last > first else "")
        series.append(Series(name, x, y))
    title = f"by {axis.name}"
    return Panel(
        title,
        subject.label(metric),
        "share of repetitions",
        series,
        x_log=spans_decades(values.ravel()),
        y_range=(0, 1.02),
    )


def _distribution(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the corners of the empirical distribution of some values, without infinite ones."""
    finite = np.sort(values[np.isfinite(values)])
    steps = np.arange(len(finite) + 1) / max(len(values), 1)
    x = np.repeat(finite, 2)
    y = np.repeat(steps, 2)[1:-1]
    return x, y


def _in_order(subject: Subject, metric: str) -> Curves:
    ranked = subject.ranked
    rank = np.array(spaced_indices(len(ranked), POINTS), dtype=float) + 1.0
    ranked = [ranked[place] for place in spaced_indices(len(ranked), POINTS)]
    values = subject.measurements.values[metric]
    low, high = np.full(len(ranked), np.nan), np.full(len(ranked), np.nan)
    for place, cell in enumerate(ranked):
        present = values[cell][~np.isnan(values[cell])]
        low[place], high[place] = np.quantile(present, (0.05, 0.95), method="inverted_cdf")
    low, high = (np.where(np.isfinite(edge), edge, np.nan) for edge in (low, high))
    medians = subject.medians[metric][ranked]
    hints, runs = subject.hints(ranked), subject.hashes(ranked)
    series = Series("", rank, medians, "points_line", low, high, hints=hints, runs=runs)
    panel = Panel("", "cells in order", subject.label(metric), [series], y_log=spans_decades(values.ravel()))
    return Curves(
        "Median of each cell in order; shaded the range of its repetitions, from their 5 % to their 95 % quantile. "
        + QUANTILE_RULE,
        [panel],
        columns=1,
    )


def motions_section(subject: Subject, shown: Mapping[int, Run], at: str) -> Section:
    """Return the motions of cells that differ only in the question.

    Args:
        subject: The sweep.
        shown: The run of each cell that is shown.
        at: The condition that they share; empty for none.
    """
    asked = find_question(subject.axes, subject.measurements.question)
    names = {
        cell: f"{asked.name}={asked.text(int(asked.level[cell]))}" if asked else subject.cell_name(cell)
        for cell in shown
    }
    where = [Text(literal(f"The runs differ only in {asked.name}, at {at}."))] if asked and at else []
    return Section("Motions", (*where, *motion_blocks({names[cell]: run for cell, run in shown.items()})))


def extremes_section(subject: Subject, shown: Mapping[int, Run]) -> Section:
    """Return the cells with the lowest and the highest median of the first metric, and some motions.

    Args:
        subject: The sweep, with at least one ranked cell.
        shown: The run of each cell that is shown, by ascending median.
    """
    ranked = subject.ranked
    ends = [ranked[0], ranked[-1]] if len(ranked) > 1 else [ranked[0]]
    motions = motion_blocks({subject.cell_name(cell): run for cell, run in shown.items()})
    return Section("Lowest and highest median", (_medians(subject, ends), *motions))


def _medians(subject: Subject, cells: Sequence[int]) -> Table:
    rows = []
    for name in subject.metrics:
        unit = subject.measurements.units[name]
        rows.append(
            [
                title(name),
                *(_with_interval(subject.measurements.of_cell(name, cell), unit) for cell in cells),
            ]
        )
    return Table(
        literal(
            f"The cells with the lowest and the highest {title(subject.metrics[0])}: medians, in brackets their 95 % "
            "intervals by the bootstrap over n repetitions. Compared in pairs says which differences are shown."
        ),
        ["metric", *numbers(*map(subject.cell_name, cells))],
        rows,
    )


def _with_interval(values: np.ndarray, unit: str) -> str:
    if not values.size:
        return "–"
    interval = median_interval(values)
    text, ends, _ = with_ends(interval.median, interval.low, interval.high, unit)
    return f"{text} (n = {interval.n})" if interval.low is None else f"{text} ({ends}, n = {interval.n})"


def motion_blocks(runs: Mapping[str, Run]) -> list[Block]:
    """Return curves and motions of repetition 0 of some runs by their names, or the reason why there are none."""
    try:
        if len(runs) == 1:
            (run,) = runs.values()
            curves = torque_and_error(run, "Torque of each joint and tip position error, repetition 0.")
            return [curves, playback(run, "The motion of repetition 0.")]
        return overlaid(list(runs.values()), list(runs))
    except StoreError as error:
        return [Notice("warning", "No motion to show", literal(str(error)))]
