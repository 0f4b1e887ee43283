"""Heat maps as a still SVG."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from runner.drawing import palette
from runner.drawing.figure import FloatArray, Map, MapFigure
from runner.drawing.map_scale import (
    CONTOURS,
    MOST_PARTED,
    OVERLAY,
    printed_values,
    prints_values,
    scale_marks,
    scaled,
    value_range,
)
from runner.drawing.stills import WIDTH, cut, literal, names_beside, set_names, to_svg

# Measures in inches.
_LEFT, _RIGHT, _TOP, _BOTTOM, _BAR, _LEGEND = 0.7, 0.12, 0.3, 0.42, 1.0, 0.16
_CHARACTER, _LINE = 0.054, 0.13
_COLORS = "viridis"
_BRIGHT = 0.6  # share of the scale of colours from which black is read more easily than white


def draw(maps: MapFigure) -> str:
    """Return the maps as SVG; the same maps give the same text."""
    return to_svg(lambda: _figure(maps))


def _figure(maps: MapFigure) -> Figure:
    columns = max(1, min(maps.columns, len(maps.panels)))
    rows = -(-len(maps.panels) // columns)
    cell = (WIDTH - _BAR) / columns
    width = cell - _LEFT - _RIGHT
    height = {1: 2.6, 2: 1.8}.get(columns, 1.3)
    row = _TOP + height + _BOTTOM + (_LEGEND if any(series.name for p in maps.panels for series in p.lines) else 0.0)
    total = rows * row
    figure = Figure(figsize=(WIDTH, total))
    low, high = value_range(maps)
    colors = Normalize(low, high if high > low else low + 1.0)
    for number, panel in enumerate(maps.panels):
        left, top = (number % columns) * cell + _LEFT, (number // columns) * row + _TOP
        place = (left / WIDTH, 1 - (top + height) / total, width / WIDTH, height / total)
        _draw_map(figure.add_axes(place), panel, maps, colors, (width, height))
    bar = figure.add_axes(((WIDTH - _BAR + 0.15) / WIDTH, 1 - (_TOP + height) / total, 0.1 / WIDTH, height / total))
    places, marks = scale_marks(maps)
    figure.colorbar(ScalarMappable(colors, _COLORS), cax=bar).set_ticks(places, labels=marks)
    literal(bar.yaxis.label, cut(maps.value_label, height / _CHARACTER))
    bar.grid(False)
    return figure


def _draw_map(axes: Axes, panel: Map, maps: MapFigure, colors: Normalize, size: tuple[float, float]) -> None:
    literal(axes.set_title("", loc="left", y=1.0, pad=4), cut(panel.title, size[0] / _CHARACTER))
    literal(axes.xaxis.label, cut(panel.x_label, size[0] / _CHARACTER))
    literal(axes.yaxis.label, cut(panel.y_label, size[1] / _CHARACTER))
    values = scaled(panel.values, maps.log)
    axes.grid(False)
    rows, columns = values.shape
    if panel.contours:
        axes.contourf(values, CONTOURS, cmap=_COLORS, norm=colors)
        axes.contour(values, CONTOURS, colors="white", linewidths=0.5)
    else:
        # Cells are centred on whole numbers, as curves over them expect.
        edges = np.arange(columns + 1) - 0.5, np.arange(rows + 1) - 0.5
        parted = "white" if max(values.shape) <= MOST_PARTED else "face"  # no edge at all leaves seams
        axes.pcolormesh(*edges, values, cmap=_COLORS, norm=colors, edgecolor=parted, linewidth=0.4)
    axes.set_xlim(-0.5, columns - 0.5)
    axes.set_ylim(-0.5, rows - 0.5)
    set_names(axes.xaxis, panel.x_names, names_beside(panel.x_names, size[0]))
    set_names(axes.yaxis, panel.y_names, int(size[1] / _LINE))
    for series in panel.lines:
        axes.plot(series.x, series.y, "--", color=palette.color(OVERLAY), linewidth=1.4)
    failed_rows, failed_columns = np.nonzero(panel.failed)
    axes.plot(failed_columns, failed_rows, "x", color=palette.color(OVERLAY), markersize=6, markeredgewidth=1.5)
    if prints_values(panel, maps):
        _print_values(axes, panel, maps, values, colors)
    named = [(line, series.name) for line, series in zip(axes.lines, panel.lines, strict=False) if series.name]
    if named:
        legend = axes.legend(
            [line for line, _ in named],
            ["name"] * len(named),
            loc="upper left",
            bbox_to_anchor=(0, -(_BOTTOM - 0.02) / size[1]),
            frameon=False,
            borderaxespad=0,
            borderpad=0,
        )
        for text, (_, name) in zip(legend.get_texts(), named, strict=True):
            literal(text, cut(name, size[0] / _CHARACTER))


def _print_values(axes: Axes, panel: Map, maps: MapFigure, shades: FloatArray, colors: Normalize) -> None:
    """Print the value of each cell, in white where the cell is dark."""
    for row, texts in enumerate(printed_values(panel, maps)):
        for column, value in enumerate(texts):
            bright = np.isnan(shades[row, column]) or colors(float(shades[row, column])) > _BRIGHT
            text = axes.text(column, row, "", ha="center", va="center", fontsize=5.5)
            text.set_color("black" if bright else "white")
            literal(text, value)
