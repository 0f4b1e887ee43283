"""Figures as plain data: curves on axes, maps of coloured cells, and long curves with fewer points."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.reporting.block import ReportBlock
from runner.reporting.table import Origin

POINTS = 2000
"""Most points of a drawn curve: more than a screen or a printed page can show."""
_SMOOTH, _UNSEEN = 200, 5e-4  # samples from which on a curve is coarsened, and share of its range that is not seen


@dataclass(frozen=True)
class Series:
    """One curve.

    Attributes:
        name: Its legend entry; with an empty name it is in no legend.
        x: Abscissae, shape (T,).
        y: Ordinates, shape (T,); NaN breaks the line.
        style: Line, dashed line, dotted line, single points, or points joined by a line.
        low: Lower edge of a shaded band around the curve, or lower ends of upright bars at single points, shape (T,),
            or None.
        high: Upper edge of the band, or upper ends, shape (T,), or None.
        color: Index into the palette; None takes the next one. Curves that belong together share it.
        hints: Text at the pointer for each point, or none.
        runs: Hash of the run behind each point, one for each, or none.
        label: Text next to its last point, instead of a legend entry.
        level: True if it is a level of an axis: its mark and dash are those of its colour.
        shift: What is added to the abscissae only where they are drawn, so that points at one place are seen, shape
            (T,); None for nothing.
    """

    name: str
    x: FloatArray
    y: FloatArray
    style: Literal["line", "dashed", "dotted", "points", "points_line"] = "line"
    low: FloatArray | None = None
    high: FloatArray | None = None
    color: int | None = None
    hints: Sequence[str] = ()
    runs: Sequence[str] = ()
    label: str = ""
    level: bool = False
    shift: FloatArray | None = None


def shifted(series: Series) -> Series:
    """Return a series with its abscissae at the places where its points are drawn."""
    return series if series.shift is None else replace(series, x=series.x + series.shift, shift=None)


def upright(series: Series) -> bool:
    """Return True if a curve is an upright line."""
    return bool(series.x.size) and bool((series.x == series.x[0]).all())


@dataclass(frozen=True)
class Panel:
    """One pair of axes with its curves; labels carry the unit, as in "tip error (m)".

    With `x_names` the abscissae are places 0, 1, ... with these names below them; `y_names` are names of ordinates.
    Without `has_legend` its title or the caption names its curves.
    """

    title: str
    x_label: str
    y_label: str
    series: Sequence[Series]
    x_log: bool = False
    y_log: bool = False
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    x_names: Sequence[str] = ()
    has_legend: bool = True
    y_names: Sequence[str] = ()


NOTHING = "never"
"""Word in a panel without any value, as in a cell of a map."""


def is_empty(panel: Panel) -> bool:
    """Return True if the named curves of a panel have places, but no value at any of them."""
    named = [series for series in panel.series if (series.name or series.label) and series.x.size]
    return bool(named) and not any(np.isfinite(series.y).any() for series in named)


def shares_legend(panels: Sequence[Panel]) -> bool:
    """Return True if one legend serves several panels: their named curves have the same names, styles and colours."""
    entries = [
        [(series.name, series.style, series.color) for series in panel.series if series.name and panel.has_legend]
        for panel in panels
    ]
    return len(panels) > 1 and bool(entries[0]) and all(each == entries[0] for each in entries)


@dataclass(frozen=True)
class Map:
    """One grid of coloured cells: rows from below, columns from the left.

    Attributes:
        title: Title.
        x_label: Name of the horizontal axis.
        y_label: Name of the vertical axis.
        x_names: Name of each column.
        y_names: Name of each row.
        values: Value of each cell, shape (rows, columns); NaN leaves it empty.
        failed: True if a cell is marked as failed, shape (rows, columns).
        lines: Curves over the grid, abscissae counted in columns and ordinates in rows, both from 0.
        contours: True if it shows lines of equal value instead of cells.
        hints: Text at the pointer for each cell, row by row, or none.
        runs: Hash of the run behind each cell, row by row, or none.
        low: Lower end of the interval of each value, shape (rows, columns); NaN where it has none. None if none has.
        high: Upper end, in the same form.
    """

    title: str
    x_label: str
    y_label: str
    x_names: Sequence[str]
    y_names: Sequence[str]
    values: FloatArray
    failed: NDArray[np.bool_]
    lines: Sequence[Series] = ()
    contours: bool = False
    hints: Sequence[str] = ()
    runs: Sequence[str] = ()
    low: FloatArray | None = None
    high: FloatArray | None = None


@dataclass(frozen=True)
class Curves(ReportBlock):
    """A figure of curves: interactive in HTML (zoom, hover, legend toggles), a still in the PDF.

    Attributes:
        caption: What is seen, in a sentence; inline mathematics as in a report's Text.
        panels: The axes, in reading order.
        columns: Number of panels side by side.
        origin: Its number in the source, command and commit.
        finding: Main result in a few words, bold before the caption; empty for none.
    """

    block: ClassVar[str] = "chart"
    word: ClassVar[str] = "figure"
    actions: ClassVar[tuple[str, ...]] = ("enlarge", "svg", "csv")
    caption: str
    panels: Sequence[Panel]
    columns: int = 2
    origin: Origin = field(default_factory=Origin)
    finding: str = ""

    def texts(self) -> Iterator[str]:
        """Yield the finding and the caption."""
        yield from (self.finding, self.caption)


@dataclass(frozen=True)
class Maps(ReportBlock):
    """Heat maps with one scale of colours: interactive in HTML, a still in the PDF.

    Attributes:
        caption: What is seen, in a sentence; inline mathematics as in a report's Text.
        value_label: What the colours mean, with unit.
        panels: The maps, in reading order.
        log: True if the colours follow the logarithm.
        columns: Number of maps side by side.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "chart"
    word: ClassVar[str] = "figure"
    actions: ClassVar[tuple[str, ...]] = ("enlarge", "svg", "csv")
    caption: str
    value_label: str
    panels: Sequence[Map]
    log: bool = False
    columns: int = 2
    origin: Origin = field(default_factory=Origin)

    def texts(self) -> Iterator[str]:
        """Yield the caption."""
        yield self.caption


def thin(series: Series, points: int = POINTS) -> Series:
    """Return the series with about `points` points at most.

    The curve is cut into equal runs of samples; of each run the samples stay where y (and x, where x goes back and
    forth, and the band's edges) is least and greatest, and one sample of every gap.

    Args:
        series: The curve, arrays of shape (T,).
        points: Most points to keep.

    Returns:
        The same series when it is short enough, otherwise a thinner one, arrays of shape (N,).
    """
    if series.x.size <= points:
        return series
    kept = _kept(_channels(series), points)
    low, high = (None if edge is None else edge[kept] for edge in (series.low, series.high))
    hints, runs = ([texts[index] for index in kept] if texts else () for texts in (series.hints, series.runs))
    shift = None if series.shift is None else series.shift[kept]
    return replace(series, x=series.x[kept], y=series.y[kept], low=low, high=high, hints=hints, runs=runs, shift=shift)


def envelope(series: Series, samples: int) -> Series:
    """Return a curve as the mean of every `samples` samples, with the least and the greatest of them as its band.

    So a curve that jumps at each sample is seen as wide as it jumps, and a smooth one stays a line.

    Args:
        series: The curve, arrays of shape (T,); if T is not a multiple, the last group is shorter.
        samples: How many samples make one point.
    """
    starts = np.arange(0, series.x.size, samples)
    counts = np.diff(np.append(starts, series.x.size))
    return replace(
        series,
        x=np.add.reduceat(series.x, starts) / counts,
        y=np.add.reduceat(series.y, starts) / counts,
        low=np.minimum.reduceat(series.y, starts),
        high=np.maximum.reduceat(series.y, starts),
    )


def coarsen(series: Series) -> Series:
    """Return every second, fourth, ... sample of a smooth curve, as few as show it.

    Straight lines between the samples stay within a small share of the range of y. A curve with a band, hints or gaps,
    or one that goes back and forth, stays whole.
    """
    x, y = series.x, series.y
    extra = series.low is not None or series.high is not None or series.hints or series.runs
    if x.size < _SMOOTH or extra or not np.isfinite(y).all() or not (np.diff(x) > 0.0).all():
        return series
    every = 1
    while x.size > 4 * every:
        kept = np.append(np.arange(0, x.size - 1, 2 * every), x.size - 1)
        if np.abs(np.interp(x, x[kept], y[kept]) - y).max() > _UNSEEN * np.ptp(y):
            break
        every *= 2
    kept = np.append(np.arange(0, x.size - 1, every), x.size - 1)
    return replace(series, x=x[kept], y=y[kept])


def spaced_indices(count: int, most: int) -> list[int]:
    """Return at most `most` of the indices below `count`, evenly spaced, the first and the last among them."""
    return [int(place) for place in np.linspace(0, count - 1, min(count, most)).round()]


def usable(limits: tuple[float, float] | None, log: bool) -> bool:
    """Return True if an axis can show the given range."""
    if limits is None or not all(map(math.isfinite, limits)) or limits[0] == limits[1]:
        return False
    return not log or min(limits) > 0


def bars(series: Series) -> tuple[FloatArray, FloatArray] | None:
    """Return the upright bars of single points as x and y, parted by NaN, or None where they have none."""
    if series.style != "points" or series.low is None or series.high is None:
        return None
    gap = np.full(series.x.size, np.nan)
    return np.repeat(series.x, 3), np.column_stack([series.low, series.high, gap]).ravel()


def band(series: Series) -> tuple[FloatArray, FloatArray] | None:
    """Return the outline of a series' shaded band as x and y, polygons parted by NaN, or None where it has no band."""
    if series.low is None or series.high is None or series.style == "points":
        return None
    finite = np.isfinite(series.x) & np.isfinite(series.low) & np.isfinite(series.high)
    x: list[FloatArray] = []
    y: list[FloatArray] = []
    for ends in np.flatnonzero(np.diff(finite, prepend=False, append=False)).reshape(-1, 2).tolist():
        run = slice(*ends)
        x += [series.x[run], series.x[run][::-1], np.array([np.nan])]
        y += [series.high[run], series.low[run][::-1], np.array([np.nan])]
    return (np.concatenate(x)[:-1], np.concatenate(y)[:-1]) if x else None


def _channels(series: Series) -> list[FloatArray]:
    channels = [series.y]
    if np.any(np.diff(series.x[np.isfinite(series.x)]) < 0):
        channels.append(series.x)
    return channels + [edge for edge in (series.low, series.high) if edge is not None]


def _kept(channels: list[FloatArray], points: int) -> NDArray[np.intp]:
    length = channels[0].size
    count = max(1, points // (2 * len(channels)))
    edges = np.linspace(0, length, count + 1).astype(int)
    width = int(np.diff(edges).max())
    # One row per run; the last sample is repeated where a run is shorter than the longest one.
    index = np.minimum(edges[:-1, None] + np.arange(width), edges[1:, None] - 1)
    row = np.arange(count)
    kept = [np.array([0, length - 1])]
    for channel in channels:
        values = channel[index]
        missing = ~np.isfinite(values)
        kept.append(index[row, np.where(missing, np.inf, values).argmin(axis=1)])
        kept.append(index[row, np.where(missing, -np.inf, values).argmax(axis=1)])
        broken = missing.any(axis=1)
        kept.append(index[row[broken], missing.argmax(axis=1)[broken]])
    return np.unique(np.concatenate(kept))
