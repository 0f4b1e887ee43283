"""A figure of curves as a still SVG, drawn by matplotlib at the size it has on paper."""

import io
import itertools
import math
import textwrap
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter

from runner.drawing import palette
from runner.drawing.figure import CurveFigure, Panel, Series, shares_legend, upright
from runner.drawing.thinning import thin, usable
from runner.drawing.ticks import mark, minor_mark
from runner.drawing.units import in_readable_units
from runner.texts import plain

WIDTH = 6.5
"""Width of the text on paper [in]."""

# Measures in inches; fixed margins, because a layout engine costs more time than all the curves.
_LEFT, _RIGHT, _BOTTOM, _BARE = 0.64, 0.12, 0.42, 0.24  # the last one below an axis without a label
_HEIGHTS, _LOWER = {1: 1.25, 2: 1.2}, 0.95  # of the axes in so many columns, and in more
_ROWS = {2: 1.05, 3: 0.8, 4: 0.64}  # the same in so many rows, and in more
_ABOVE = 0.25  # by which a label beside an axis may be longer than it
_LINE, _CHARACTER, _HANDLE, _GAP = 0.135, 0.054, 0.42, 0.12
_POINTS_PER_INCH = 300
Corner = Literal["upper left", "lower left"]
_NAME = 14  # characters of a name below an axis
_LINES = {"line": "-", "dashed": "--", "dotted": ":", "points": "none", "points_line": "-"}
STYLE: Any = {
    "font.size": 7,
    "axes.titlesize": 7.5,
    "axes.titlepad": 4,
    "axes.linewidth": 0.5,
    "axes.edgecolor": "#555b66",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e6ea",
    "grid.linewidth": 0.5,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.0,
    "path.simplify_threshold": 0.2,
    "svg.fonttype": "path",
    "svg.hashsalt": "runner",
}


@dataclass(frozen=True)
class _Frame:
    """The texts around one panel, broken to its width, and the space they take [in]."""

    panel: Panel
    width: float
    height: float
    title: str
    names: list[str]
    columns: int
    bottom: float = _BOTTOM

    @property
    def top(self) -> float:
        return 0.1 + _LINE * (self.title.count("\n") + 1 if self.title else 0)

    @property
    def legend(self) -> float:
        named = [name for name in self.names if name]
        if not named:
            return 0.0
        lines = max(name.count("\n") + 1 for name in named)
        return math.ceil(len(named) / self.columns) * lines * _LINE + 0.05


def draw(curves: CurveFigure) -> str:
    """Return the figure as SVG; the same figure gives the same text."""
    return to_svg(lambda: _figure(curves))


def to_svg(make: Callable[[], Figure]) -> str:
    """Return what is drawn, in the style of all stills, as SVG."""
    with mpl.rc_context(STYLE), warnings.catch_warnings():
        # Characters that the font lacks become a box, and values without a logarithm leave their axes empty.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        warnings.filterwarnings("ignore", message="Data has no positive values")
        stream = io.StringIO()
        make().savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def _figure(curves: CurveFigure) -> Figure:
    columns = max(1, min(curves.columns, len(curves.panels)))
    width, panels = WIDTH / columns, in_readable_units(curves.panels, columns)
    count = math.ceil(len(panels) / columns)
    shared, height = shares_legend(panels), min(_HEIGHTS.get(columns, _LOWER), _ROWS.get(min(count, max(_ROWS)), 9.0))
    frames = [_frame(panel, width - _LEFT - _RIGHT, height, not shared) for panel in panels]
    rows = [frames[start : start + columns] for start in range(0, len(frames), columns)]
    if shared and len({panel.x_label for panel in panels}) == 1:
        # One label below the last panel of each column.
        rows[:-1] = [_bare(row, below) for row, below in itertools.pairwise(rows)]
    foot = _frame(panels[0], WIDTH - _LEFT - _RIGHT, height) if shared else None
    heights = [*map(_row_height, rows), *([foot.legend] if foot else [])]
    total = sum(heights) or _BOTTOM
    figure = Figure(figsize=(WIDTH, total))
    of_first: Sequence[Line2D] = ()
    for index, row in enumerate(rows):
        head = sum(heights[:index]) + max(frame.top for frame in row)
        for column, frame in enumerate(row):
            bottom = total - head - frame.height
            place = (column * width + _LEFT, bottom, frame.width, frame.height)
            axes = figure.add_axes((place[0] / WIDTH, place[1] / total, place[2] / WIDTH, place[3] / total))
            handles = _draw_panel(axes, frame)
            of_first = of_first or handles
            _draw_legend(axes, frame, handles, "upper left", (0, -(_BOTTOM - 0.02) / frame.height))
    if foot:
        _draw_legend(figure, foot, of_first, "lower left", (_LEFT / WIDTH, 0.0))
    return figure


def _bare(row: Sequence[_Frame], below: Sequence[_Frame]) -> list[_Frame]:
    """Return a row of panels without label where another panel stands below."""
    hidden = [replace(frame, panel=replace(frame.panel, x_label=""), bottom=_BARE) for frame in row[: len(below)]]
    return [*hidden, *row[len(below) :]]


def _frame(panel: Panel, width: float, height: float, named: bool = True) -> _Frame:
    title = wrapped(panel.title, width / _CHARACTER)
    names = [wrapped(series.name if named else "", (width - _HANDLE) / _CHARACTER) for series in panel.series]
    longest = max((len(line) for name in names for line in name.splitlines()), default=0)
    count = sum(map(bool, names))
    fitting = max(1, min(count, int((width + _GAP) / (longest * _CHARACTER + _HANDLE))))
    columns = math.ceil(count / math.ceil(count / fitting)) if count else 1
    return _Frame(panel, width, height, title, names, columns)


def _row_height(row: Sequence[_Frame]) -> float:
    return max(frame.top for frame in row) + row[0].height + max(frame.bottom + frame.legend for frame in row)


def _draw_panel(axes: Axes, frame: _Frame) -> list[Line2D]:
    panel = frame.panel
    literal(axes.set_title("", loc="left", y=1.0), frame.title)
    literal(axes.xaxis.label, cut(panel.x_label, frame.width / _CHARACTER))
    literal(axes.yaxis.label, cut(panel.y_label, (frame.height + _ABOVE) / _CHARACTER))
    if panel.x_log:
        axes.set_xscale("log", nonpositive="mask")
    if panel.y_log:
        axes.set_yscale("log", nonpositive="mask")
    axes.yaxis.set_label_coords(-(_LEFT - 0.12) / frame.width, 0.5)  # beside the widest tick labels of a log axis
    axes.margins(x=0.02)
    chosen = palette.indices([series.color for series in panel.series])
    handles = [
        _draw_series(axes, thin(series, int(_POINTS_PER_INCH * frame.width)), palette.color(color))
        for series, color in zip(panel.series, chosen, strict=True)
    ]
    if usable(panel.x_range, panel.x_log):
        axes.set_xlim(panel.x_range)
    if usable(panel.y_range, panel.y_log):
        axes.set_ylim(panel.y_range)
    if panel.x_names:
        set_names(axes.xaxis, panel.x_names, names_beside(panel.x_names, frame.width))
        axes.set_xlim(-0.5, len(panel.x_names) - 0.5)
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if panel.x_names and axis is axes.xaxis:
            continue
        axis.set_major_formatter(FuncFormatter(mark))
        if axis.get_scale() == "log":
            # Labels between the powers of ten, and only where these alone would leave the axis bare.
            axis.set_minor_formatter(FuncFormatter(minor_mark) if high < 30.0 * low else NullFormatter())
        else:
            axis.set_major_locator(MaxNLocator(max(3, int(frame.height / 0.22)) if axis is axes.yaxis else 5))
    return handles


def names_beside(names: Sequence[str], length: float) -> int:
    """Return how many of some names fit beside each other [in]."""
    longest = max((len(plain(name)) for name in names), default=0)
    return int(length / ((min(longest, _NAME) + 2) * _CHARACTER))


def set_names(axis: Axis, names: Sequence[str], room: int) -> None:
    """Name the places 0, 1, ... of an axis; where there is room for fewer names, every other one and so on."""
    step = math.ceil(len(names) / max(1, room)) or 1
    # A dollar sign begins a formula in a tick's label, and ticks are labelled anew at every drawing.
    labels = [cut(name, _NAME).replace("$", r"\$") for name in names[::step]]
    axis.set_ticks(range(0, len(names), step), labels)


def _draw_series(axes: Axes, series: Series, color: str) -> Line2D:
    if series.low is not None and series.high is not None:
        axes.fill_between(series.x, series.low, series.high, color=color, alpha=0.18, linewidth=0)
    marker = "o" if series.style in ("points", "points_line") else ""
    # What is broken stands before what is not, so that neither hides the other.
    order = 2.1 if series.style in ("dashed", "dotted") else 2.0
    (line,) = axes.plot(series.x, series.y, linestyle=_LINES[series.style], marker=marker, color=color, zorder=order)
    if series.label and series.x.size:
        end = (float(series.x[-1]), float(series.y[-1]))
        side = -1 if upright(series) else 1  # beside an upright line, above the end of a level one
        text = axes.annotate("", end, (-2 * side, 2), textcoords="offset points", color=color, fontsize=6)
        text.set_horizontalalignment("left" if upright(series) else "right")
        literal(text, plain(series.label))
    return line


def _draw_legend(
    owner: Axes | Figure, frame: _Frame, handles: Sequence[Line2D], corner: Corner, place: tuple[float, float]
) -> None:
    named = [(handle, name) for handle, name in zip(handles, frame.names, strict=True) if name]
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


def literal(label: Text, text: str) -> None:
    """Set a text of which no character means anything to matplotlib."""
    label.set_parse_math(False)
    label.set_text(text)


def wrapped(text: str, characters: float) -> str:
    """Return a text in lines of so many characters."""
    return "\n".join(textwrap.wrap(plain(text).strip(), max(10, int(characters))))


def cut(text: str, characters: float) -> str:
    """Return a text on one line of so many characters, its end cut off where it is longer."""
    text, limit = plain(text).strip(), max(10, int(characters))
    return text if len(text) <= limit else text[: limit - 1] + "…"
