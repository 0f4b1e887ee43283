"""Static drawings of figures: curves and heat maps, by matplotlib at print size."""

import io
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter

from runner.base.arrays import FloatArray
from runner.base.sanitize import plain
from runner.reporting.charts import palette, scales
from runner.reporting.charts.figure import (
    NOTHING,
    Curves,
    Map,
    Maps,
    Panel,
    Series,
    band,
    bars,
    is_empty,
    shares_legend,
    shifted,
    thin,
    upright,
    usable,
)
from runner.reporting.charts.sheet import (
    REPORT,
    NameLayout,
    Sheet,
    literal,
    names_below,
    names_beside,
    render_figure,
    style,
    wrap_text,
)

# Measures in inches, for letters of the size of a report; fixed margins, because a layout engine costs more time than
# all the curves.
_LEFT, _RIGHT, _BOTTOM, _BARE = 0.64, 0.12, 0.42, 0.24  # the last one below an axis without a label
_HEIGHTS, _LOWER = {1: 1.25, 2: 1.2}, 0.95  # of the axes by number of columns, and in more
_ROWS = {0: 9.0, 2: 1.05, 3: 0.8, 4: 0.64, 5: 0.5, 7: 0.42}  # the same by number of rows, and in more
_ABOVE = 0.15  # by which a label next to an axis of curves may be longer than it
_HANDLE, _GAP = 0.42, 0.12
_LEAST = 1.55  # width of a panel
_MAP_LEFT, _MAP_LABEL, _MAP_BAR = 0.7, 0.3, 0.36  # the last two without names and values
_MAP_HEIGHTS, _MAP_LOWER = {1: 2.6, 2: 1.8}, 1.3
_LEAST_MAP = 1.8  # width of a map with its labels
_POINTS_PER_INCH = 300
_PALE = 0.18  # of its colour in a band
_COLORS = "viridis"
_BRIGHT = 0.6  # share of the scale of colours from which black is read more easily than white
Corner = Literal["upper left", "lower left"]
_MARKS = ("o", "D", "s")
_MARKED = 7  # marks on a curve
_LINES = {"line": "-", "dashed": "--", "dotted": ":", "points": "none", "points_line": "-"}


@dataclass(frozen=True)
class _Frame:
    """The labels around one panel or map, broken to its size, and the space they take [in]."""

    panel: Panel | Map
    sheet: Sheet
    width: float
    height: float
    title: str
    entries: list[str]
    columns: int
    x_names: NameLayout | None = None
    y_names: NameLayout | None = None

    @property
    def x_label(self) -> str:
        return wrap_text(self.panel.x_label, self.width / self.sheet.character)

    @property
    def y_label(self) -> str:
        return _beside(self.panel, self.height, self.sheet)

    @property
    def top(self) -> float:
        return 0.1 + self.sheet.line * (self.title.count("\n") + 1 if self.title else 0)

    @property
    def bottom(self) -> float:
        names = self.x_names.room - self.sheet.line if self.x_names else 0.0
        if not self.x_label:
            return _BARE * self.sheet.scale + names
        return _BOTTOM * self.sheet.scale + names + self.x_label.count("\n") * self.sheet.line

    @property
    def legend(self) -> float:
        named = [name for name in self.entries if name]
        if not named:
            return 0.0
        lines = max(name.count("\n") + 1 for name in named)
        return math.ceil(len(named) / self.columns) * lines * self.sheet.line + 0.05


def draw(figure: Curves | Maps, sheet: Sheet = REPORT) -> str:
    """Return a figure as SVG; the same figure gives the same text."""
    return render_figure(lambda: _figure(figure, sheet), sheet, "svg").decode()


def draw_pdf(figure: Curves | Maps, sheet: Sheet = REPORT) -> bytes:
    """Return a figure as PDF, a page of its size; the same figure gives the same bytes."""
    return render_figure(lambda: _figure(figure, sheet), sheet, "pdf")


def as_figure(curves: Curves, sheet: Sheet = REPORT) -> Figure:
    """Return the figure as one of matplotlib's, to be changed and saved; a notebook shows it."""
    with mpl.rc_context(style(sheet)):
        return _curves(curves, sheet, _Shown)


class _Shown(Figure):
    """A figure that a notebook shows although pyplot, which may not be used there, does not know it."""

    def _repr_png_(self) -> bytes:
        return as_png(self)


def as_png(figure: Figure) -> bytes:
    """Return a figure as PNG."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=150)
    return stream.getvalue()


def _figure(figure: Curves | Maps, sheet: Sheet) -> Figure:
    return _curves(figure, sheet) if isinstance(figure, Curves) else _maps(figure, sheet)


def _curves(curves: Curves, sheet: Sheet, kind: type[Figure] = Figure) -> Figure:
    columns = sheet.beside(curves.columns, len(curves.panels), _LEAST)
    panels = curves.panels
    count, width = math.ceil(len(panels) / columns), sheet.width / columns
    height = sheet.scale * min(
        _HEIGHTS.get(columns, _LOWER), _ROWS[max((rows for rows in _ROWS if rows <= count), default=0)]
    )
    height = max(height, sheet.line * max((len(panel.y_names) for panel in panels), default=0))
    shared = shares_legend(panels)
    lines = max((_beside(panel, height, sheet).count("\n") for panel in panels), default=0)
    y_names = [names_beside(panel.y_names, height, sheet) if panel.y_names else None for panel in panels]
    named = max((names.room for names in y_names if names), default=0.0)
    left, right = max(_LEFT * sheet.scale + lines * sheet.line, named + 2.0 * sheet.line), _RIGHT * sheet.scale
    frames = [
        replace(
            _frame(panel, () if shared or not panel.has_legend else panel.series, sheet, width - left - right, height),
            y_names=names,
        )
        for panel, names in zip(panels, y_names, strict=True)
    ]
    rows = [frames[start : start + columns] for start in range(0, len(frames), columns)]
    alike = shared or not all(panel.has_legend for panel in panels)
    if alike and len({panel.x_label for panel in panels}) == 1:
        # One label below the last panel of each column.
        rows[:-1] = [_bare(row, below) for row, below in itertools.pairwise(rows)]
    foot = _frame(panels[0], panels[0].series, sheet, sheet.width - left - right, height) if shared else None
    total = sum(map(_row_height, rows)) + (foot.legend if foot else 0.0) or _BOTTOM
    figure = kind(figsize=(sheet.width, total))
    of_first: Sequence[Line2D] = ()
    for frame, axes in _placed(figure, rows, width, left, total):
        handles = _draw_panel(axes, frame)
        of_first = of_first or handles
        _draw_legend(axes, frame, handles, "upper left", (0, -(frame.bottom - 0.02) / frame.height))
    if foot:
        _draw_legend(figure, foot, of_first, "lower left", (left / sheet.width, 0.03 / total))
    return figure


def _maps(maps: Maps, sheet: Sheet) -> Figure:
    places, marks = scales.scale_marks(maps)
    widest = max(map(len, marks), default=0)
    label = _MAP_BAR * sheet.scale + 2 * sheet.line  # of the scale, in two lines at most
    room = sheet.width - label - widest * sheet.character
    columns = sheet.beside(maps.columns, len(maps.panels), _LEAST_MAP, room)
    cell, height = room / columns, sheet.scale * _MAP_HEIGHTS.get(columns, _MAP_LOWER)
    y_names = [names_beside(panel.y_names, height, sheet) for panel in maps.panels]
    lines = max((_beside(panel, height, sheet).count("\n") for panel in maps.panels), default=0)
    taken = max((names.room for names in y_names), default=0.0) + lines * sheet.line
    left = max(_MAP_LEFT * sheet.scale, _MAP_LABEL * sheet.scale + taken)
    width = cell - left - _RIGHT * sheet.scale
    frames = [
        replace(_frame(panel, panel.lines, sheet, width, height), y_names=names)
        for panel, names in zip(maps.panels, y_names, strict=True)
    ]
    rows = [frames[start : start + columns] for start in range(0, len(frames), columns)]
    total = sum(map(_row_height, rows)) or height
    figure = Figure(figsize=(sheet.width, total))
    colors = Normalize(*scales.value_range(maps))
    for frame, axes in _placed(figure, rows, cell, left, total):
        handles = _draw_map(axes, frame, maps, colors)
        _draw_legend(axes, frame, handles, "upper left", (0, -(frame.bottom - 0.02) / frame.height))
    bottom = 1 - (max((frame.top for frame in rows[0]), default=0.0) + height) / total if rows else 0.0
    bar = figure.add_axes(((room + 0.1) / sheet.width, bottom, 0.1 / sheet.width, height / total))
    scale = figure.colorbar(ScalarMappable(colors, _COLORS), cax=bar)
    scale.set_ticks(places, labels=marks)
    if scale.solids is not None:
        scale.solids.set(rasterized=False, edgecolor="face")  # vectors without seams
    literal(bar.yaxis.label, wrap_text(maps.value_label, height / sheet.character))
    bar.grid(False)
    return figure


def _placed(
    figure: Figure, rows: Sequence[Sequence[_Frame]], cell: float, left: float, total: float
) -> Iterator[tuple[_Frame, Axes]]:
    """Yield each frame with axes at its place; `cell` is the width of a column, `total` the height of the figure."""
    head = 0.0
    for row in rows:
        top = head + max(frame.top for frame in row)
        for place, frame in enumerate(row):
            across, bottom = (place * cell + left) / frame.sheet.width, 1 - (top + frame.height) / total
            size = frame.width / frame.sheet.width, frame.height / total
            yield frame, figure.add_axes((across, bottom, *size))
        head += _row_height(row)


def _beside(panel: Panel | Map, height: float, sheet: Sheet) -> str:
    """Return the label next to an axis of a height, broken to it."""
    return wrap_text(panel.y_label, (height + (_ABOVE if isinstance(panel, Panel) else 0.0)) / sheet.character)


def _bare(row: Sequence[_Frame], below: Sequence[_Frame]) -> list[_Frame]:
    """Return a row of panels without label if another panel is below."""
    hidden = [replace(frame, panel=replace(frame.panel, x_label="")) for frame in row[: len(below)]]
    return [*hidden, *row[len(below) :]]


def _frame(panel: Panel | Map, lines: Sequence[Series], sheet: Sheet, width: float, height: float) -> _Frame:
    """Return the frame of a panel, with a legend of some curves."""
    title = wrap_text(panel.title, width / sheet.character)
    handle = _HANDLE * sheet.scale
    entries = [wrap_text(series.name, (width - handle) / sheet.character) for series in lines]
    longest = max((len(line) for name in entries for line in name.splitlines()), default=0)
    count = sum(map(bool, entries))
    fitting = max(1, min(count, int((width + _GAP) / (longest * sheet.character + handle))))
    columns = math.ceil(count / math.ceil(count / fitting)) if count else 1
    x_names = names_below(panel.x_names, width, sheet) if panel.x_names else None
    return _Frame(panel, sheet, width, height, title, entries, columns, x_names)


def _row_height(row: Sequence[_Frame]) -> float:
    return max(frame.top for frame in row) + row[0].height + max(frame.bottom + frame.legend for frame in row)


def _label(axes: Axes, frame: _Frame) -> None:
    literal(axes.set_title("", loc="left", y=1.0, pad=4), frame.title)
    literal(axes.xaxis.label, frame.x_label)
    literal(axes.yaxis.label, frame.y_label)


def _draw_panel(axes: Axes, frame: _Frame) -> list[Line2D]:
    panel, sheet = frame.panel, frame.sheet
    assert isinstance(panel, Panel)  # noqa: S101 - for the type checker
    _label(axes, frame)
    if panel.x_log:
        axes.set_xscale("log", nonpositive="mask")
    if panel.y_log:
        axes.set_yscale("log", nonpositive="mask")
    # Next to the widest tick labels of a log axis, or to the names of places.
    names = frame.y_names.room + sheet.line if frame.y_names else 0.0
    axes.yaxis.set_label_coords(-max((_LEFT - 0.12) * sheet.scale, names) / frame.width, 0.5)
    axes.margins(x=0.02)
    chosen = palette.indices([series.color for series in panel.series])
    handles = [
        _draw_series(
            axes, shifted(thin(series, int(_POINTS_PER_INCH * frame.width))), color, sheet, len(set(chosen)) > 1
        )
        for series, color in zip(panel.series, chosen, strict=True)
    ]
    if usable(panel.x_range, panel.x_log):
        axes.set_xlim(panel.x_range)
    if usable(panel.y_range, panel.y_log):
        axes.set_ylim(panel.y_range)
    if frame.x_names:
        frame.x_names.put(axes.xaxis, len(panel.x_names))
        axes.set_xlim(-0.5, len(panel.x_names) - 0.5)
    else:
        whole = all((series.x[np.isfinite(series.x)] % 1.0 == 0.0).all() for series in panel.series)
        _mark(axes, "x", 5, whole)
    if is_empty(panel):
        literal(axes.text(0.5, 0.5, "", ha="center", va="center", transform=axes.transAxes), NOTHING)
    if frame.y_names:
        frame.y_names.put(axes.yaxis, len(panel.y_names))
        axes.set_ylim(-0.5, len(panel.y_names) - 0.5)
    else:
        _mark(axes, "y", max(3, int(frame.height / (0.22 * sheet.scale))))
    return handles


def _mark(axes: Axes, which: Literal["x", "y"], most: int, whole: bool = False) -> None:
    """Label the marks of an axis in one notation; of a linear one at most `most`, only at whole numbers if asked."""
    axis, (low, high) = (axes.xaxis, axes.get_xlim()) if which == "x" else (axes.yaxis, axes.get_ylim())
    log = axis.get_scale() == "log"
    write = scales.marks(low, high, log)
    axis.set_major_formatter(_formatter(write))
    if log:
        # Labels between the powers of ten, only if an axis would have too few without them.
        axis.set_minor_formatter(_formatter(scales.at_2_and_5(write)) if high < 30.0 * low else NullFormatter())
    else:
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10], integer=whole))


def _formatter(write: scales.Mark) -> FuncFormatter:
    return FuncFormatter(lambda value, _: write(value))


def _draw_series(axes: Axes, series: Series, index: int, sheet: Sheet, several: bool) -> Line2D:
    color = palette.color(index)
    if band(series) is not None and series.low is not None and series.high is not None:
        # A pale colour and no transparency, which journals refuse; thin edges show through another band.
        red, green, blue = (1.0 - _PALE * (1.0 - part) for part in to_rgb(color))
        axes.fill_between(series.x, series.low, series.high, color=(red, green, blue), linewidth=0)
        for edge in (series.low, series.high):
            axes.plot(series.x, edge, color=color, linewidth=0.3, zorder=1.8)
    if (upright_bars := bars(series)) is not None:
        axes.plot(*upright_bars, color=color)
    marked = (sheet.marked or series.level) and several
    look = index % len(palette.MARKS)
    mark = palette.MARKS[look] if marked else _MARKS[min(palette.rounds(index), len(_MARKS) - 1)]
    pointed = series.style in ("points", "points_line")
    places = axes.transScale.transform(np.column_stack([series.x, series.y]))  # NaN without a logarithm
    whole = np.isfinite(series.y).all() and np.isfinite(places).all(axis=1).any()
    marker = mark if pointed or (marked and series.name and whole) else ""
    # Marks of curves that are close to each other have different places.
    every = None if pointed else ((index % 8 + 1) / (8 * _MARKED), 1 / _MARKED)
    # Broken lines are in front of others, so that neither hides the other; a white edge parts a mark from its curve.
    dashes = palette.DASHES[look] if series.level and not pointed else ()
    order = 2.1 if dashes or series.style in ("dashed", "dotted") else 2.0
    if marker and not pointed:
        parted: dict[str, Any] = {"markeredgecolor": "white", "markeredgewidth": 0.5, "markersize": 4.0}
    else:
        parted = {}
    (line,) = axes.plot(series.x, series.y, linestyle=(0, dashes) if dashes else _LINES[series.style], marker=marker,
                       color=color, zorder=order, markevery=every, **parted)  # fmt: skip
    if series.label and series.x.size:
        end = (float(series.x[-1]), float(series.y[-1]))
        side = -1 if upright(series) else 1  # next to an upright line, above the end of a level one
        text = axes.annotate("", end, (-2 * side, 2), textcoords="offset points", color=color, fontsize=sheet.small)
        text.set_horizontalalignment("left" if upright(series) else "right")
        literal(text, plain(series.label))
    return line


def _draw_legend(
    owner: Axes | Figure, frame: _Frame, handles: Sequence[Line2D], corner: Corner, place: tuple[float, float]
) -> None:
    named = [(handle, name) for handle, name in zip(handles, frame.entries, strict=False) if name]
    if not named:
        return
    # matplotlib fills columns first; a reader goes along the rows.
    named = [entry for column in range(frame.columns) for entry in named[column :: frame.columns]]
    legend = owner.legend(
        [handle for handle, _ in named],
        ["name"] * len(named),
        loc=corner,
        bbox_to_anchor=place,
        ncols=frame.columns,
        frameon=False,
        borderaxespad=0,
        borderpad=0,
        handlelength=2.2,
        columnspacing=1.2,
        labelspacing=0.3,
    )
    # Names are set afterwards, because matplotlib gives a meaning to a leading underscore.
    for text, (_, name) in zip(legend.get_texts(), named, strict=True):
        literal(text, name)


def _draw_map(axes: Axes, frame: _Frame, maps: Maps, colors: Normalize) -> list[Line2D]:
    panel = frame.panel
    assert isinstance(panel, Map)  # noqa: S101 - for the type checker
    _label(axes, frame)
    values = scales.scale_values(panel.values, maps.log)
    axes.grid(False)
    rows, columns = values.shape
    if panel.contours:
        levels = np.linspace(*scales.value_range(maps), scales.CONTOURS + 1)
        axes.contourf(values, levels, cmap=_COLORS, norm=colors)
        crossed = levels[(levels > np.nanmin(values)) & (levels < np.nanmax(values))]
        if crossed.size:
            axes.contour(values, crossed, colors="white", linewidths=0.5)
    else:
        # Cells are centred on whole numbers, as curves over them expect.
        edges = np.arange(columns + 1) - 0.5, np.arange(rows + 1) - 0.5
        parted = "white" if max(values.shape) <= scales.MOST_PARTED else "face"  # no edge at all leaves seams
        axes.pcolormesh(*edges, values, cmap=_COLORS, norm=colors, edgecolor=parted, linewidth=0.4)
    axes.set_xlim(-0.5, columns - 0.5)
    axes.set_ylim(-0.5, rows - 0.5)
    for names, axis, count in ((frame.x_names, axes.xaxis, columns), (frame.y_names, axes.yaxis, rows)):
        if names:
            names.put(axis, count)
    color = palette.color(scales.OVERLAY)
    handles = [
        line for series in panel.lines for line in axes.plot(series.x, series.y, "--", color=color, linewidth=1.4)
    ]
    failed_rows, failed_columns = np.nonzero(panel.failed)
    axes.plot(failed_columns, failed_rows, "x", color=color, markersize=6, markeredgewidth=1.5)
    if scales.prints_values(panel, maps):
        _print_values(axes, frame, scales.printed_values(panel, maps), values, colors)
    return handles


def _print_values(
    axes: Axes, frame: _Frame, values: Sequence[Sequence[str]], shades: FloatArray, colors: Normalize
) -> None:
    """Print the value of each cell, in white where the cell is dark; none where they are wider than the cells."""
    letter = frame.sheet.character * frame.sheet.small / frame.sheet.font
    if letter * max((len(text) for row in values for text in row), default=0) > frame.width / max(1, shades.shape[1]):
        return
    for row, texts in enumerate(values):
        for column, value in enumerate(texts):
            bright = np.isnan(shades[row, column]) or colors(float(shades[row, column])) > _BRIGHT
            text = axes.text(column, row, "", ha="center", va="center", fontsize=frame.sheet.small)
            text.set_color("black" if bright else "white")
            literal(text, value)
