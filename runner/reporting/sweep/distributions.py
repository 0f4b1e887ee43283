"""Distributions of a metric, and the cells with the lowest and the highest median."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import StoreError
from runner.base.quantities import format_range, quantity, with_ends
from runner.reporting.charts.figure import POINTS, spaced_indices
from runner.reporting.document import Curves, Notice, Panel, ReportBlock, Section, Series, Table, Text
from runner.reporting.figures import playback, torque_and_error
from runner.reporting.markup import literal
from runner.reporting.metric_titles import title
from runner.reporting.overlaid_runs import Level, overlaid
from runner.reporting.sweep.subject import QUANTILE_RULE, Subject, group_levels, spans_decades
from runner.reporting.table import numbers
from runner.statistics import median_interval
from runner.store import Run
from runner.store.axes import Axis
from runner.sweeps.question import SEED, find_question, is_condition

_MOST_LEVELS, _MOST_CELLS = 6, 24  # whose curves are shown
_MOST_NAMED = 8  # cells below an axis


def section(subject: Subject) -> Section:
    """Return the distributions of the first metric."""
    metric = subject.metrics[0]
    panels = [_shares(subject, metric, axis) for axis in subject.axes]
    blocks: list[ReportBlock] = []
    if panels:
        caption = (
            f"Share of all repetitions in which the {title(metric)} is at most the value below; a curve that "
            "ends below 1 leaves repetitions that failed or never settled."
        )
        for axis in subject.axes:
            count = int(group_levels(axis).max()) + 1
            shown = len(subject.looks(axis))
            caption += f" {shown} of {count} values of {axis.name} are shown." if shown < count else ""
        blocks.append(Curves(literal(caption), panels, columns=min(2, len(panels))))
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
    for group, look in subject.looks(axis).items():
        chosen = groups == group
        pooled = values[chosen]
        x, y = _distribution(pooled[~np.isnan(pooled)])
        first, last = int(axis.level[chosen].min()), int(axis.level[chosen].max())
        name = axis.text(first) + (f" to {axis.text(last)}" if last > first else "")
        series.append(Series(name, x, y, color=look, level=True))
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
    places = spaced_indices(len(subject.ranked), POINTS)
    ranked = [subject.ranked[place] for place in places]
    x, across, names = np.array(places, dtype=float) + 1.0, "rank of the cell, by median", []
    if len(ranked) <= _MOST_NAMED:
        swept = [axis for axis in subject.axes if len(axis.values) > 1]
        x, across = x - 1.0, "cell: " + ", ".join(axis.name for axis in swept)
        names = [", ".join(axis.text(int(axis.level[cell])) for axis in swept) for cell in ranked]
    values = subject.measurements.values[metric]
    low, high = np.full(len(ranked), np.nan), np.full(len(ranked), np.nan)
    for place, cell in enumerate(ranked):
        present = values[cell][~np.isnan(values[cell])]
        low[place], high[place] = np.quantile(present, (0.05, 0.95), method="inverted_cdf")
    low, high = (np.where(np.isfinite(edge), edge, np.nan) for edge in (low, high))
    medians = subject.medians[metric][ranked]
    hints, runs = subject.hints(ranked), subject.hashes(ranked)
    series = Series("", x, medians, "points" if names else "points_line", low, high, hints=hints, runs=runs)
    panel = Panel("", across, subject.label(metric), [series], y_log=spans_decades(values.ravel()), x_names=names)
    return Curves(
        "Median of each cell, in ascending order, and the range of its repetitions from their 5 % to their 95 % "
        f"quantile. {QUANTILE_RULE}",
        [panel],
        columns=1,
    )


@dataclass(frozen=True)
class ShownCells:
    """The cells whose curves and motions a report shows.

    Attributes:
        axis: The axis whose levels are told apart; None if only seeds were swept.
        cells: The cells of each of its levels, by ascending median, the name of the level, and its look.
        at: What all of them share, such as "noise.position=0.001"; empty for nothing.
    """

    axis: Axis | None
    cells: Sequence[tuple[str, Sequence[int], int]]
    at: str = ""


def choose_cells(subject: Subject, among: Sequence[int], at: str = "") -> ShownCells:
    """Return the cells to show: of some levels of the question, or of the first axis, some that are spread evenly."""
    axes = [axis for axis in subject.axes if axis.name != SEED]
    axis = find_question(subject.axes, subject.measurements.question) or next(iter(axes), None)
    allowed = set(among)
    ordered = [cell for cell in subject.order.tolist() if cell in allowed]
    sound = [cell for cell in ordered if subject.measurements.statuses[cell] == "ok"]
    if axis is None:
        return ShownCells(None, [("all seeds", _some(sound or ordered, _MOST_CELLS), 0)], at)
    groups, looks = group_levels(axis), subject.looks(axis)
    found = {group: [cell for cell in sound if groups[cell] == group]
             or [cell for cell in ordered if groups[cell] == group] for group in looks}  # fmt: skip
    kept = [group for group, cells in found.items() if cells]
    kept = [kept[place] for place in spaced_indices(len(kept), _MOST_LEVELS)]
    most = max(1, _MOST_CELLS // max(1, len(kept)))
    cells = [(f"{axis.name}={axis.text(int(axis.level[found[group][0]]))}", _some(found[group], most), looks[group])
             for group in kept]  # fmt: skip
    return ShownCells(axis, cells, at)


def _some(cells: Sequence[int], most: int) -> list[int]:
    return [cells[place] for place in spaced_indices(len(cells), most)]


def motions_section(subject: Subject, shown: ShownCells, runs: Mapping[int, Run]) -> Section:
    """Return the motions of cells that differ only in the question and the seed.

    Args:
        subject: The sweep.
        shown: The cells.
        runs: The run of each of them.
    """
    where = (
        [Text(literal(f"The runs differ only in {shown.axis.name}, at {shown.at}."))] if shown.axis and shown.at else []
    )
    return Section("Motions", (*where, *_motions(subject, shown, runs)))


def extremes_section(subject: Subject, shown: ShownCells, runs: Mapping[int, Run]) -> Section:
    """Return the cells with the lowest and the highest median of the first metric, and some motions.

    Args:
        subject: The sweep, with at least one ranked cell.
        shown: The cells whose curves and motions are shown.
        runs: The run of each of them.
    """
    ranked = subject.ranked
    ends = [ranked[0], ranked[-1]] if len(ranked) > 1 else [ranked[0]]
    return Section("Lowest and highest median", (_medians(subject, ends), *_motions(subject, shown, runs)))


def _motions(subject: Subject, shown: ShownCells, runs: Mapping[int, Run]) -> list[ReportBlock]:
    levels = [Level(name, [runs[cell] for cell in cells], look) for name, cells, look in shown.cells]
    count = sum(len(cells) for _, cells, _ in shown.cells)
    others = [axis for axis in subject.axes if axis is not shown.axis]
    names = [subject.cell_name(cells[0], others) for _, cells, _ in shown.cells]
    where = ", ".join(filter(None, [shown.at, *_spans(subject, shown, others)]))
    told = f" {count} of {len(subject.measurements.hashes)} cells{f': {where}' if where else ''}."
    played = "; ".join(
        f"{name}{f' at {at}' if at else ''}" for (name, _, _), at in zip(shown.cells, names, strict=True)
    )
    return motion_blocks(levels, literal(told), literal(played))


def _spans(subject: Subject, shown: ShownCells, others: Sequence[Axis]) -> Iterator[str]:
    """Yield the values of the other axes that the shown cells have, where they are not shared by all."""
    cells = [cell for _, some, _ in shown.cells for cell in some]
    for axis in others:
        levels = np.unique(axis.level[cells]).tolist()
        if f"{axis.name}=" not in shown.at:
            yield f"{axis.name}={axis.text(levels[0])}{f' to {axis.text(levels[-1])}' if len(levels) > 1 else ''}"


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


def motion_blocks(levels: Sequence[Level], told: str = "", played: str = "") -> list[ReportBlock]:
    """Return curves and motions of repetition 0 of some runs, or the reason why there are none; see `overlaid`."""
    try:
        if len(levels) == 1 and len(levels[0].runs) == 1:
            (run,) = levels[0].runs
            curves = torque_and_error(run, f"Torque of each joint and tip position error, repetition 0.{told}")
            return [curves, playback(run, "The motion of repetition 0.")]
        return overlaid(levels, told, played)
    except StoreError as error:
        return [Notice("warning", "No motion to show", literal(str(error)))]
