"""Figures of curves as stills, drawn by matplotlib at print size."""

import io
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter

from runner.base.sanitize import plain
from runner.reporting.charts import palette
from runner.reporting.charts.axes import Mark, at_2_and_5, in_readable_units, marks
from runner.reporting.charts.figure import Curves, Panel, Series, shares_legend, upright
from runner.reporting.charts.names import Names, literal, names_below, wrap_text
from runner.reporting.charts.sheet import REPORT, Sheet, render_figure, style
from runner.reporting.charts.thinning import thin, usable

# Measures in inches, for letters of the size of a report; fixed margins, because a layout engine costs more time than
# all the curves.
_LEFT, _RIGHT, _BOTTOM, _BARE = 0.64, 0.12, 0.42, 0.24  # the last one below an axis without a label
_HEIGHTS, _LOWER = {1: 1.25, 2: 1.2}, 0.95  # of the axes in so many columns, and in more
_ROWS = {2: 1.05, 3: 0.8, 4: 0.64}  # the same in so many rows, and in more
_ABOVE = 0.15  # by which a label beside an axis may be longer than it
_HANDLE, _GAP = 0.42, 0.12
_LEAST = 1.55  # width of a panel
_POINTS_PER_INCH = 300
_PALE = 0.18  # of its colour in a band
Corner = Literal["upper left", "lower left"]
_MARKS = ("o", "D", "s")
_LINES = {"line": "-", "dashed": "--", "dotted": ":", "points": "none", "points_line": "-"}


@dataclass(frozen=True)
class _Frame:
    """The texts around one panel, broken to its width, and the space they take [in]."""

    panel: Panel
    sheet: Sheet
    width: float
    height: float
    title: str
    entries: list[str]
    columns: int
    x_names: Names | None = None

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


def draw(curves: Curves, sheet: Sheet = REPORT) -> str:
    """Return the figure as SVG; the same figure gives the same text."""
    return render_figure(lambda: _figure(curves, sheet), sheet, "svg").decode()


def draw_pdf(curves: Curves, sheet: Sheet = REPORT) -> bytes:
    """Return the figure as PDF, a page of its size; the same figure gives the same bytes."""
    return render_figure(lambda: _figure(curves, sheet), sheet, "pdf")


def as_figure(curves: Curves, sheet: Sheet = REPORT) -> Figure:
    """Return the figure as one of matplotlib's, to be changed and saved; a notebook shows it."""
    with mpl.rc_context(style(sheet)):
        return _figure(curves, sheet, _Shown)


class _Shown(Figure):
    """A figure that a notebook shows although pyplot, which may not be used there, does not know it."""

    def _repr_png_(self) -> bytes:
        stream = io.BytesIO()
        self.savefig(stream, format="png", dpi=150)
        return stream.getvalue()


def _figure(curves: Curves, sheet: Sheet, kind: type[Figure] = Figure) -> Figure:
    columns = sheet.beside(curves.columns, len(curves.panels), _LEAST)
    panels = in_readable_units(curves.panels, curves.columns)
    count, width = math.ceil(len(panels) / columns), sheet.width / columns
    height = sheet.scale * min(_HEIGHTS.get(columns, _LOWER), _ROWS.get(min(count, max(_ROWS)), 9.0))
    shared = shares_legend(panels)
    lines = max((_beside(panel, height, sheet).count("\n") for panel in panels), default=0)
    left, right = _LEFT * sheet.scale + lines * sheet.line, _RIGHT * sheet.scale
    frames = [_frame(panel, sheet, width - left - right, height, not shared) for panel in panels]
    rows = [frames[start : start + columns] for start in range(0, len(frames), columns)]
    if shared and len({panel.x_label for panel in panels}) == 1:
        # One label below the last panel of each column.
        rows[:-1] = [_bare(row, below) for row, below in itertools.pairwise(rows)]
    foot = _frame(panels[0], sheet, sheet.width - left - right, height) if shared else None
    heights = [*map(_row_height, rows), *([foot.legend] if foot else [])]
    total = sum(heights) or _BOTTOM
    figure = kind(figsize=(sheet.width, total))
    of_first: Sequence[Line2D] = ()
    for index, row in enumerate(rows):
        head = sum(heights[:index]) + max(frame.top for frame in row)
        for place, frame in enumerate(row):
            bottom = total - head - frame.height
            axes = figure.add_axes(
                ((place * width + left) / sheet.width, bottom / total, frame.width / sheet.width, frame.height / total)
            )
            handles = _draw_panel(axes, frame)
            of_first = of_first or handles
            _draw_legend(axes, frame, handles, "upper left", (0, -(frame.bottom - 0.02) / frame.height))
    if foot:
        _draw_legend(figure, foot, of_first, "lower left", (left / sheet.width, 0.03 / total))
    return figure


def _beside(panel: Panel, height: float, sheet: Sheet) -> str:
    """Return the label beside an axis of a height, broken to it."""
    return wrap_text(panel.y_label, (height + _ABOVE) / sheet.character)


def _bare(row: Sequence[_Frame], below: Sequence[_Frame]) -> list[_Frame]:
    """Return a row of panels without label where another panel stands below."""
    hidden = [replace(frame, panel=replace(frame.panel, x_label="")) for frame in row[: len(below)]]
    return [*hidden, *row[len(below) :]]


def _frame(panel: Panel, sheet: Sheet, width: float, height: float, named: bool = True) -> _Frame:
    title = wrap_text(panel.title, width / sheet.character)
    handle = _HANDLE * sheet.scale
    entries = [wrap_text(series.name if named else "", (width - handle) / sheet.character) for series in panel.series]
    longest = max((len(line) for name in entries for line in name.splitlines()), default=0)
    count = sum(map(bool, entries))
    fitting = max(1, min(count, int((width + _GAP) / (longest * sheet.character + handle))))
    columns = math.ceil(count / math.ceil(count / fitting)) if count else 1
    x_names = names_below(panel.x_names, width, sheet) if panel.x_names else None
    return _Frame(panel, sheet, width, height, title, entries, columns, x_names)


def _row_height(row: Sequence[_Frame]) -> float:
    return max(frame.top for frame in row) + row[0].height + max(frame.bottom + frame.legend for frame in row)


def _draw_panel(axes: Axes, frame: _Frame) -> list[Line2D]:
    panel, sheet = frame.panel, frame.sheet
    literal(axes.set_title("", loc="left", y=1.0), frame.title)
    literal(axes.xaxis.label, frame.x_label)
    literal(axes.yaxis.label, frame.y_label)
    if panel.x_log:
        axes.set_xscale("log", nonpositive="mask")
    if panel.y_log:
        axes.set_yscale("log", nonpositive="mask")
    # Beside the widest tick labels of a log axis.
    axes.yaxis.set_label_coords(-(_LEFT - 0.12) * sheet.scale / frame.width, 0.5)
    axes.margins(x=0.02)
    chosen = palette.indices([series.color for series in panel.series])
    handles = [
        _draw_series(axes, thin(series, int(_POINTS_PER_INCH * frame.width)), color, sheet)
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
    _mark(axes, "y", max(3, int(frame.height / (0.22 * sheet.scale))))
    return handles


def _mark(axes: Axes, which: Literal["x", "y"], most: int, whole: bool = False) -> None:
    """Label the marks of an axis in one notation; of a linear one so many at most, at whole numbers alone if asked."""
    axis, (low, high) = (axes.xaxis, axes.get_xlim()) if which == "x" else (axes.yaxis, axes.get_ylim())
    log = axis.get_scale() == "log"
    write = marks(low, high, log)
    axis.set_major_formatter(_formatter(write))
    if log:
        # Labels between the powers of ten, and only where these alone would leave the axis bare.
        axis.set_minor_formatter(_formatter(at_2_and_5(write)) if high < 30.0 * low else NullFormatter())
    else:
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10], integer=whole))


def _formatter(write: Mark) -> FuncFormatter:
    return FuncFormatter(lambda value, _: write(value))


def _draw_series(axes: Axes, series: Series, index: int, sheet: Sheet) -> Line2D:
    color = palette.color(index)
    if series.low is not None and series.high is not None:
        # A pale colour and no transparency, which journals refuse; thin edges show through another band.
        red, green, blue = (1.0 - _PALE * (1.0 - part) for part in to_rgb(color))
        axes.fill_between(series.x, series.low, series.high, color=(red, green, blue), linewidth=0)
        for edge in (series.low, series.high):
            axes.plot(series.x, edge, color=color, linewidth=0.3, zorder=1.8)
    mark = _MARKS[min(palette.rounds(index), len(_MARKS) - 1)]
    marker = mark if series.style in ("points", "points_line") else ""
    # What is broken stands before what is not, so that neither hides the other.
    order = 2.1 if series.style in ("dashed", "dotted") else 2.0
    (line,) = axes.plot(series.x, series.y, linestyle=_LINES[series.style], marker=marker, color=color, zorder=order)
    if series.label and series.x.size:
        end = (float(series.x[-1]), float(series.y[-1]))
        side = -1 if upright(series) else 1  # beside an upright line, above the end of a level one
        text = axes.annotate("", end, (-2 * side, 2), textcoords="offset points", color=color, fontsize=sheet.small)
        text.set_horizontalalignment("left" if upright(series) else "right")
        literal(text, plain(series.label))
    return line


def _draw_legend(
    owner: Axes | Figure, frame: _Frame, handles: Sequence[Line2D], corner: Corner, place: tuple[float, float]
) -> None:
    named = [(handle, name) for handle, name in zip(handles, frame.entries, strict=True) if name]
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
