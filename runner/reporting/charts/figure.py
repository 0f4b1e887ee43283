"""Figures as plain data: curves on axes, and maps of coloured cells."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray


@dataclass(frozen=True)
class Series:
    """One curve.

    Attributes:
        name: Its legend entry; with an empty name it stands in no legend.
        x: Abscissae, shape (T,).
        y: Ordinates, shape (T,); NaN breaks the line.
        style: Line, dashed line, dotted line, single points, or points joined by a line.
        low: Lower edge of a shaded band around the curve, shape (T,), or None.
        high: Upper edge of the band, shape (T,), or None.
        color: Index into the palette; None takes the next one. Curves that belong together share it.
        hints: What the reader is told of each point when pointing at it, one for each, or none.
        runs: Hash of the run behind each point, one for each, or none.
        label: What stands beside its last point, in place of a legend entry.
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


def upright(series: Series) -> bool:
    """Tell whether a curve is an upright line."""
    return bool(series.x.size) and bool((series.x == series.x[0]).all())


@dataclass(frozen=True)
class Panel:
    """One pair of axes with its curves; labels carry the unit, as in "tip error (m)".

    With `x_names` the abscissae are places 0, 1, ... with these names below them.
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


def shares_legend(panels: Sequence[Panel]) -> bool:
    """Tell whether one legend serves several panels: their named curves have the same names, styles and colours."""
    entries = [
        [(series.name, series.style, series.color) for series in panel.series if series.name] for panel in panels
    ]
    return len(panels) > 1 and bool(entries[0]) and all(each == entries[0] for each in entries)


@dataclass(frozen=True)
class Map:
    """One grid of coloured cells: rows from below, columns from the left.

    Attributes:
        title: What stands above it.
        x_label: Name of the horizontal axis.
        y_label: Name of the vertical axis.
        x_names: Name of each column.
        y_names: Name of each row.
        values: Value of each cell, shape (rows, columns); NaN leaves it empty.
        failed: Whether a cell is marked as failed, shape (rows, columns).
        lines: Curves over the grid, abscissae counted in columns and ordinates in rows, both from 0.
        contours: Whether it shows lines of equal value in place of cells.
        hints: What the reader is told of each cell, row by row, or none.
        runs: Hash of the run behind each cell, row by row, or none.
        low: Lower end of the interval of each value, shape (rows, columns); NaN where it has none. None if none has.
        high: Upper end, likewise.
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
class Origin:
    """Where a figure or table comes from: its number in the source, the command that makes it, the commit."""

    number: str = ""
    command: str = ""
    commit: str = ""


@dataclass(frozen=True)
class Curves:
    """A figure of curves: interactive in HTML (zoom, hover, legend toggles), a still in the PDF.

    Attributes:
        caption: What is seen, in a sentence; inline mathematics as in a report's Text.
        panels: The axes, in reading order.
        columns: How many panels stand beside each other.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "curves"
    caption: str
    panels: Sequence[Panel]
    columns: int = 2
    origin: Origin = field(default_factory=Origin)


@dataclass(frozen=True)
class Maps:
    """Heat maps with one scale of colours: interactive in HTML, a still in the PDF.

    Attributes:
        caption: What is seen, in a sentence; inline mathematics as in a report's Text.
        value_label: What the colours mean, with unit.
        panels: The maps, in reading order.
        log: Whether the colours follow the logarithm.
        columns: How many maps stand beside each other.
        origin: Its number in the source, command and commit.
    """

    block: ClassVar[str] = "maps"
    caption: str
    value_label: str
    panels: Sequence[Map]
    log: bool = False
    columns: int = 2
    origin: Origin = field(default_factory=Origin)
