"""Heat maps as stills, drawn by matplotlib at print size."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from runner.base.arrays import FloatArray
from runner.reporting.charts import map_scale, palette
from runner.reporting.charts.axes import map_in_readable_units
from runner.reporting.charts.figure import Map, Maps
from runner.reporting.charts.names import Names, literal, names_below, names_beside, wrap_text
from runner.reporting.charts.sheet import REPORT, Sheet, render_figure

# Measures in inches, for letters of the size of a report.
_LEFT, _LABEL, _RIGHT, _BOTTOM, _BAR = 0.7, 0.3, 0.12, 0.42, 0.36  # the second and last without names and values
_HEIGHTS, _LOWER = {1: 2.6, 2: 1.8}, 1.3
_LEAST = 1.8  # width of a map with what stands beside it
_COLORS = "viridis"
_BRIGHT = 0.6  # share of the scale of colours from which black is read more easily than white


@dataclass(frozen=True)
class _Frame:
    """One map with its texts, broken to its size, and the space that they take [in]."""

    panel: Map
    sheet: Sheet
    width: float
    height: float
    x_names: Names
    y_names: Names

    @property
    def title(self) -> str:
        return wrap_text(self.panel.title, self.width / self.sheet.character)

    @property
    def x_label(self) -> str:
        return wrap_text(self.panel.x_label, self.width / self.sheet.character)

    @property
    def lines(self) -> list[str]:
        return [wrap_text(series.name, self.width / self.sheet.character) for series in self.panel.lines]

    @property
    def top(self) -> float:
        return 0.1 + self.sheet.line * (self.title.count("\n") + 1.2)

    @property
    def bottom(self) -> float:
        below = self.x_names.room - self.sheet.line + self.x_label.count("\n") * self.sheet.line
        return _BOTTOM * self.sheet.scale + below

    @property
    def legend(self) -> float:
        return sum(name.count("\n") + 1.2 for name in self.lines if name) * self.sheet.line


def draw(maps: Maps, sheet: Sheet = REPORT) -> str:
    """Return the maps as SVG; the same maps give the same text."""
    return render_figure(lambda: _figure(maps, sheet), sheet, "svg").decode()


def draw_pdf(maps: Maps, sheet: Sheet = REPORT) -> bytes:
    """Return the maps as PDF, a page of their size; the same maps give the same bytes."""
    return render_figure(lambda: _figure(maps, sheet), sheet, "pdf")


def _figure(maps: Maps, sheet: Sheet) -> Figure:
    maps = map_in_readable_units(maps)
    places, marks = map_scale.scale_marks(maps)
    widest = max(map(len, marks), default=0)
    label = _BAR * sheet.scale + 2 * sheet.line  # of the scale, in two lines at most
    room = sheet.width - label - widest * sheet.character
    columns = sheet.beside(maps.columns, len(maps.panels), _LEAST, room)
    cell, height = room / columns, sheet.scale * _HEIGHTS.get(columns, _LOWER)
    y_names = [names_beside(panel.y_names, height, sheet) for panel in maps.panels]
    lines = max((_beside(panel, height, sheet).count("\n") for panel in maps.panels), default=0)
    taken = max((names.room for names in y_names), default=0.0) + lines * sheet.line
    left = max(_LEFT * sheet.scale, _LABEL * sheet.scale + taken)
    width = cell - left - _RIGHT * sheet.scale
    frames = [
        _Frame(panel, sheet, width, height, names_below(panel.x_names, width, sheet), names)
        for panel, names in zip(maps.panels, y_names, strict=True)
    ]
    rows = [frames[start : start + columns] for start in range(0, len(frames), columns)]
    heights = [
        max(frame.top for frame in row) + height + max(frame.bottom + frame.legend for frame in row) for row in rows
    ]
    total = sum(heights) or height
    figure = Figure(figsize=(sheet.width, total))
    colors = Normalize(*map_scale.value_range(maps))
    tops = [sum(heights[:index]) + max(frame.top for frame in row) for index, row in enumerate(rows)]
    for top, row in zip(tops, rows, strict=True):
        for number, frame in enumerate(row):
            place = (number * cell + left) / sheet.width, 1 - (top + height) / total
            _draw_map(figure.add_axes((*place, width / sheet.width, height / total)), frame, maps, colors)
    bottom = 1 - ((tops[0] if tops else 0.0) + height) / total
    bar = figure.add_axes(((room + 0.1) / sheet.width, bottom, 0.1 / sheet.width, height / total))
    figure.colorbar(ScalarMappable(colors, _COLORS), cax=bar).set_ticks(places, labels=marks)
    literal(bar.yaxis.label, wrap_text(maps.value_label, height / sheet.character))
    bar.grid(False)
    return figure


def _beside(panel: Map, height: float, sheet: Sheet) -> str:
    return wrap_text(panel.y_label, height / sheet.character)


def _draw_map(axes: Axes, frame: _Frame, maps: Maps, colors: Normalize) -> None:
    panel, sheet = frame.panel, frame.sheet
    literal(axes.set_title("", loc="left", y=1.0, pad=4), frame.title)
    literal(axes.xaxis.label, frame.x_label)
    literal(axes.yaxis.label, _beside(panel, frame.height, sheet))
    values = map_scale.scale_values(panel.values, maps.log)
    axes.grid(False)
    rows, columns = values.shape
    if panel.contours:
        levels = np.linspace(*map_scale.value_range(maps), map_scale.CONTOURS + 1)
        axes.contourf(values, levels, cmap=_COLORS, norm=colors)
        crossed = levels[(levels > np.nanmin(values)) & (levels < np.nanmax(values))]
        if crossed.size:
            axes.contour(values, crossed, colors="white", linewidths=0.5)
    else:
        # Cells are centred on whole numbers, as curves over them expect.
        edges = np.arange(columns + 1) - 0.5, np.arange(rows + 1) - 0.5
        parted = "white" if max(values.shape) <= map_scale.MOST_PARTED else "face"  # no edge at all leaves seams
        axes.pcolormesh(*edges, values, cmap=_COLORS, norm=colors, edgecolor=parted, linewidth=0.4)
    axes.set_xlim(-0.5, columns - 0.5)
    axes.set_ylim(-0.5, rows - 0.5)
    frame.x_names.put(axes.xaxis, columns)
    frame.y_names.put(axes.yaxis, rows)
    for series in panel.lines:
        axes.plot(series.x, series.y, "--", color=palette.color(map_scale.OVERLAY), linewidth=1.4)
    failed_rows, failed_columns = np.nonzero(panel.failed)
    axes.plot(
        failed_columns, failed_rows, "x", color=palette.color(map_scale.OVERLAY), markersize=6, markeredgewidth=1.5
    )
    if map_scale.prints_values(panel, maps):
        _print_values(axes, frame, maps, values, colors)
    named = [(line, name) for line, name in zip(axes.lines, frame.lines, strict=False) if name]
    if named:
        legend = axes.legend(
            [line for line, _ in named],
            ["name"] * len(named),
            loc="upper left",
            bbox_to_anchor=(0, -(frame.bottom - 0.02) / frame.height),
            frameon=False,
            borderaxespad=0,
            borderpad=0,
        )
        for text, (_, name) in zip(legend.get_texts(), named, strict=True):
            literal(text, name)


def _print_values(axes: Axes, frame: _Frame, maps: Maps, shades: FloatArray, colors: Normalize) -> None:
    """Print the value of each cell, in white where the cell is dark; none where they are wider than the cells."""
    values = map_scale.printed_values(frame.panel, maps)
    letter = frame.sheet.character * frame.sheet.small / frame.sheet.font
    if letter * max((len(text) for row in values for text in row), default=0) > frame.width / max(1, shades.shape[1]):
        return
    for row, texts in enumerate(values):
        for column, value in enumerate(texts):
            bright = np.isnan(shades[row, column]) or colors(float(shades[row, column])) > _BRIGHT
            text = axes.text(column, row, "", ha="center", va="center", fontsize=frame.sheet.small)
            text.set_color("black" if bright else "white")
            literal(text, value)
