"""Figures over the runs of a pattern: signals over time, numbers over an axis, heat maps."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.papers.study.results import Runs, axes_of, called, matching_runs, other
from runner.papers.study.run_values import Signal, number_of, trace_of
from runner.reporting.document import Curves, Map, Maps, Panel, Series
from runner.reporting.figures import AXES, captioned, origin
from runner.store import Run

Style = Literal["line", "dashed", "dotted", "points", "points_line"]
_POINTS = 100  # of the curve of a closed form
_MARGIN = 0.05  # of the range of y, above and below what is drawn


def line(
    runs: Runs,
    pattern: str,
    signal: Signal,
    name: str = "",
    *others: str,
    style: Style = "line",
    color: int | None = None,
    factor: float = 1.0,
    until: float | None = None,
    words: Mapping[str, str] | None = None,
    x: Signal | None = None,
) -> list[Series]:
    """Return a signal over time, or over another signal, of each run that a pattern stands for.

    Args:
        runs: The runs of the study by name.
        pattern: Name of a run, with axes in braces.
        signal: A column of the trace, or a function of a run, or of a run and others.
        name: What the legend calls it, with axes in braces.
        others: Names of the other runs, with the pattern's axes in braces.
        style: How it is drawn.
        color: Index of the first one's color; None takes the next ones.
        factor: What its values are multiplied by, such as 1000 for mm.
        until: End of the time, in s; None for all.
        words: What a level is called in the legend.
        x: The signal that replaces the time.
    """
    series = []
    for index, each in enumerate(matching_runs(runs, pattern)):
        values = factor * trace_of(signal, each.run, *(other(runs, twin, each.levels) for twin in others))
        t = each.run.t[: len(values)]
        shown = t <= np.inf if until is None else t <= until + 1e-9
        own = None if color is None else color + index
        place = t if x is None else trace_of(x, each.run)
        series.append(Series(called(name, each.levels, words or {}), place[shown], values[shown], style, color=own))
    return series


def joints(runs: Runs, run: str, signal: Signal = "q", name: str = "q") -> list[Series]:
    """Return a signal of each joint over time: q, dq, tau or another with a column for each joint, or a function's."""
    values = signal(runs[run]) if callable(signal) else runs[run].joints(signal)
    t = runs[run].t[: len(values)]
    return [Series(f"{name}{joint + 1}", t, column) for joint, column in enumerate(values.T)]


def axes(runs: Runs, run: str, stem: str = "error", factor: float = 1.0) -> list[Series]:
    """Return a multiple of a vector's x, y and z over time: tip, desired, error or another that has these columns."""
    return [
        Series(axis, runs[run].t[: len(values)], factor * values, color=index)
        for index, axis in enumerate(AXES)
        for values in [trace_of(f"{stem}_{axis}", runs[run])]
    ]


def over(
    runs: Runs,
    pattern: str,
    axis: str,
    what: Signal,
    name: str = "",
    *others: str,
    style: Style = "points_line",
    color: int | None = None,
    words: Mapping[str, str] | None = None,
    x: Callable[[Run], float] | None = None,
    x_factor: float = 1.0,
    though_failed: bool = False,
) -> list[Series]:
    """Return a number of runs against an axis, a curve for each combination of the pattern's other axes.

    A metric has a band from the least to the largest of its repetitions, where these differ and a line joins points.

    Args:
        runs: The runs of the study by name.
        pattern: Names of the runs, with axes in braces.
        axis: The axis, whose levels are numbers; other levels are drawn at 0, 1, ...
        what: Name of a metric, or a function of a run, or of others, that gives a number.
        name: What the legend calls it, with the other axes in braces.
        others: Names of the other runs, with the pattern's axes in braces.
        style: How it is drawn.
        color: Index of the first one's color; None takes the next ones.
        words: What a level is called in the legend.
        x: Gives the abscissa of a run; the level where it is left out.
        x_factor: What the abscissae are multiplied by, such as 1000 for mm.
        though_failed: Whether what a function reads of a run until it failed is shown.
    """
    if axis not in axes_of(pattern):
        raise RunnerError(f"the pattern {pattern} has no axis '{axis}'; axes: {', '.join(axes_of(pattern)) or 'none'}")
    curves: dict[tuple[str, ...], list[tuple[float, float, float, float]]] = {}
    levels: dict[tuple[str, ...], Mapping[str, str]] = {}
    for each in matching_runs(runs, pattern):
        key = tuple(level for own, level in each.levels.items() if own != axis)
        points = curves.setdefault(key, [])
        levels[key] = each.levels
        of = [other(runs, one, each.levels) for one in others] or [each.run]
        place = _abscissa(each.levels[axis], len(points)) if x is None else x(each.run)
        points.append((place, *_with_ends(what, of, though_failed)))
    series = []
    for index, (key, points) in enumerate(curves.items()):
        at, y, low, high = (np.array(column) for column in zip(*points, strict=True))
        joined = style != "points"  # a band between points that nothing joins would say what lies between
        band = (low, high) if joined and np.any(high > low) else (None, None)
        own = None if color is None else color + index
        legend = called(name, levels[key], words or {})
        series.append(Series(legend, x_factor * at, y, style, band[0], band[1], own))
    return series


def points(
    runs: Runs,
    pattern: str,
    x: Signal,
    y: Callable[..., float],
    name: str = "",
    *others: str,
    only: Callable[[Run], bool] | None = None,
    where: bool = True,
    color: int | None = None,
) -> list[Series]:
    """Return two numbers of each run that a pattern stands for as points.

    Args:
        runs: The runs of the study by name.
        pattern: Names of the runs, with axes in braces.
        x: The abscissa: an axis, whose levels are numbers, or a function of a run.
        y: The ordinate: a function of a run, or of a run and others.
        name: What the legend calls them.
        others: Names of the other runs, with the pattern's axes in braces.
        only: A function that is as `where` says of the runs that are shown; all are shown where it is left out.
        where: What that function is of these runs.
        color: Index of their color; None takes the next one.
    """
    shown = [each for each in matching_runs(runs, pattern) if only is None or only(each.run) is where]
    places = [(x(each.run) if callable(x) else float(each.levels[x]),
               y(each.run, *(other(runs, twin, each.levels) for twin in others))) for each in shown]  # fmt: skip
    across, up = np.array(places, float).reshape(-1, 2).T
    return [Series(name, across, up, "points", color=color)]


def closed_form(
    function: Callable[[float], float | None],
    low: float,
    high: float,
    name: str,
    style: Style = "dashed",
    color: int | None = None,
    log: bool = False,
) -> list[Series]:
    """Return a function between two abscissae, which with `log` are spaced by equal ratios."""
    x = np.geomspace(low, high, _POINTS) if log else np.linspace(low, high, _POINTS)
    values = (function(float(each)) for each in x)
    return [Series(name, x, np.array([np.nan if y is None else y for y in values]), style, color=color)]


def limit(
    value: float, low: float, high: float, name: str = "", style: Style = "dotted", color: int | None = None
) -> list[Series]:
    """Return a level line at a value, from one abscissa to another."""
    return [Series(name, np.array([low, high], float), np.array([value, value], float), style, color=color)]


def upright(
    value: float, low: float, high: float, name: str = "", style: Style = "dotted", color: int | None = None
) -> list[Series]:
    """Return an upright line at an abscissa, from one ordinate to another."""
    return [Series(name, np.array([value, value], float), np.array([low, high], float), style, color=color)]


def panel(
    title: str,
    x_label: str,
    y_label: str,
    *series: Sequence[Series],
    x_log: bool = False,
    y_log: bool = False,
    x_range: tuple[float, float] | None = None,
    y_range: tuple[float, float] | None = None,
    x_names: Sequence[str] = (),
) -> Panel:
    """Return one pair of axes; on an axis of powers of ten zeros are left out."""
    drawn = [_positive(each, x_log, y_log) for own in series for each in own]
    ranges = [None if own is None else (float(own[0]), float(own[1])) for own in (x_range, y_range)]
    return Panel(title, x_label, y_label, drawn, x_log, y_log, ranges[0], ranges[1], tuple(x_names))


def same_y(*panels: Panel) -> list[Panel]:
    """Return panels that are to be compared, all with the range of y that shows what any of them has."""
    drawn = [edge for each in panels for series in each.series for edge in (series.y, series.low, series.high)]
    values = np.concatenate([edge[np.isfinite(edge)] for edge in drawn if edge is not None] or [np.zeros(0)])
    if not values.size or values.min() == values.max():
        return list(panels)
    log = any(each.y_log for each in panels)
    low, high = (np.log(values.min()), np.log(values.max())) if log else (values.min(), values.max())
    ends = np.array([low - _MARGIN * (high - low), high + _MARGIN * (high - low)])
    low, high = map(float, np.exp(ends) if log else ends)
    return [replace(each, y_range=(low, high)) for each in panels]


def curves(
    runs: Runs,
    caption: str,
    run: str,
    *panels: Panel | Sequence[Panel],
    columns: int | None = None,
    number: str = "",
) -> Curves:
    """Return a figure of some panels, side by side.

    Args:
        runs: The runs of the study by name.
        caption: What is seen, after its finding and a line break if it has one; inline mathematics as in Text.
        run: The run whose command is printed under the figure.
        panels: The axes in reading order, one by one or several in one, as `same_y` gives them.
        columns: Number of panels in a row; at most two if it is omitted.
        number: Its number in the source.
    """
    drawn = [each for given in panels for each in ([given] if isinstance(given, Panel) else given)]
    return captioned(caption, drawn, columns or min(2, len(drawn)), origin(runs[run], number))


def heat_map(
    runs: Runs,
    caption: str,
    pattern: str,
    x: str,
    y: str,
    what: Signal,
    value_label: str,
    x_label: str = "",
    y_label: str = "",
    log: bool = False,
    number: str = "",
) -> Maps:
    """Return a number of runs over two axes, a map for each combination of the pattern's other axes."""
    panels: dict[tuple[str, ...], dict[tuple[str, str], Run]] = {}
    for each in matching_runs(runs, pattern, (y, x)):
        key = tuple(level for axis, level in each.levels.items() if axis not in (x, y))
        panels.setdefault(key, {})[each.levels[y], each.levels[x]] = each.run
    maps = [_map(" ".join(key), cells, what, x_label or x, y_label or y) for key, cells in panels.items()]
    return Maps(caption, value_label, maps, log, min(2, len(maps)), origin(matching_runs(runs, pattern)[0].run, number))


def _map(title: str, cells: Mapping[tuple[str, str], Run], what: Signal, x_label: str, y_label: str) -> Map:
    rows, columns = (list(dict.fromkeys(place[index] for place in cells)) for index in (0, 1))
    values = np.full((len(rows), len(columns)), np.nan)
    failed = np.zeros(values.shape, bool)
    for (row, column), run in cells.items():
        place = rows.index(row), columns.index(column)
        value = None if run.status == "failed" else number_of(what, run)
        values[place] = np.nan if value is None else value
        failed[place] = run.status == "failed"
    return Map(title, x_label, y_label, columns, rows, values, failed)


def _abscissa(level: str, place: int) -> float:
    try:
        return float(level)
    except ValueError:
        return float(place)


def _with_ends(what: Signal, runs: Sequence[Run], though_failed: bool) -> tuple[float, float, float]:
    """Return a number with the least and the largest of its repetitions; NaN where it has no value."""
    if runs[0].status == "failed" and not though_failed:
        return (np.nan,) * 3
    value = number_of(what, *runs)
    if value is None:
        return (np.nan,) * 3
    stored = runs[0].metrics[what] if isinstance(what, str) else None
    low, high = (value, value) if stored is None else (stored.min, stored.max)
    return value, value if low is None else float(low), value if high is None else float(high)


def _positive(series: Series, x_log: bool, y_log: bool) -> Series:
    """Return a curve without the values that an axis of powers of ten has no place for."""
    kept = series.x > 0.0 if x_log else np.ones(len(series.x), bool)

    def cut(values: FloatArray) -> FloatArray:
        return np.where(values[kept] > 0.0, values[kept], np.nan) if y_log else values[kept]

    ends = [None if own is None else cut(own) for own in (series.low, series.high)]
    return replace(series, x=series.x[kept], y=cut(series.y), low=ends[0], high=ends[1])
