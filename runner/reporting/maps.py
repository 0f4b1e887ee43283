"""Heat maps as data for Plotly: one plot per map, all with one scale of colours."""

from typing import Any

import numpy as np

from runner.reporting.curves import named_places, neutral
from runner.reporting.document import FloatArray, Map, Maps
from runner.reporting.quantities import digits_between, number

Json = dict[str, Any]

OVERLAY = 1
"""Palette index of what lies over the cells, red, which their colours do not hold."""
CONTOURS = 10
"""About how many lines of equal value a map shows."""
MOST_PARTED = 20
"""Most cells beside each other that are parted by white lines."""
_MOST_PRINTED = 10  # cells beside each other whose values can be read


def maps_spec(block: Maps) -> list[Json]:
    """Return what the page's script hands to Plotly: for each map traces, palette indices and layout."""
    low, high = value_range(block)
    return [_map(panel, block, low, high) for panel in block.panels]


def scaled(values: FloatArray, log: bool) -> FloatArray:
    """Return what the colours follow: the values or their logarithms, NaN where there is none."""
    if not log:
        return np.where(np.isfinite(values), values, np.nan)
    positive = np.isfinite(values) & (values > 0)
    return np.log10(values, out=np.full(values.shape, np.nan), where=positive)


def value_range(block: Maps) -> tuple[float, float]:
    """Return the ends of the scale of colours, as scaled."""
    everything = np.concatenate([np.zeros(0), *(scaled(panel.values, block.log).ravel() for panel in block.panels)])
    finite = everything[np.isfinite(everything)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


def scale_marks(block: Maps) -> tuple[list[float], list[str]]:
    """Return where the scale of colours is marked, as scaled, and with which values."""
    low, high = value_range(block)
    places = np.linspace(low, high, 5 if high > low else 1)
    values = 10.0**places if block.log else places
    digits = digits_between(values[0], values[-1])
    return places.tolist(), [number(float(value), digits) for value in values]


def _map(panel: Map, block: Maps, low: float, high: float) -> Json:
    columns, rows = list(range(len(panel.x_names))), list(range(len(panel.y_names)))
    colors = scaled(panel.values, block.log)
    places, marks = scale_marks(block)
    drawn: Json = {
        "type": "contour" if panel.contours else "heatmap",
        "x": columns,
        "y": rows,
        "z": [[None if np.isnan(value) else round(float(value), 9) for value in row] for row in colors],
        "zmin": low,
        "zmax": high if high > low else low + 1.0,
        "colorscale": "Viridis",
        "colorbar": {
            "thickness": 10,
            "outlinewidth": 0,
            "tickvals": places,
            "ticktext": marks,
            "title": {"text": neutral(block.value_label), "side": "right"},
        },
        "hoverinfo": "skip",
    }
    if panel.contours:
        drawn |= {"ncontours": CONTOURS, "line": {"width": 0.7, "color": "#ffffff"}}
    elif max(panel.values.shape) <= MOST_PARTED:
        drawn |= {"xgap": 1, "ygap": 1}
    if prints_values(panel, block):
        drawn |= {"text": printed_values(panel, block), "texttemplate": "%{text}"}
    if panel.hints:
        drawn |= {"hovertext": _by_rows([neutral(hint) for hint in panel.hints], len(columns)), "hoverinfo": "text"}
    if panel.runs:
        drawn["customdata"] = _by_rows(list(panel.runs), len(columns))
    traces = [drawn, *_overlay(panel)]
    layout = {
        "xaxis": {"title": {"text": neutral(panel.x_label)}, **named_places(panel.x_names)},
        "yaxis": {"title": {"text": neutral(panel.y_label)}, **named_places(panel.y_names)},
        "showlegend": any(series.name for series in panel.lines),
        "hovermode": "closest",
    }
    return {"traces": traces, "colors": [OVERLAY] * len(traces), "layout": layout}


def _overlay(panel: Map) -> list[Json]:
    """Return what lies over the cells: curves, and crosses on failed cells."""
    traces: list[Json] = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": neutral(series.name),
            "showlegend": bool(series.name),
            "hoverinfo": "skip",
            "line": {"width": 2.5, "dash": "dash"},
            "x": series.x.tolist(),
            "y": series.y.tolist(),
        }
        for series in panel.lines
    ]
    rows, columns = np.nonzero(panel.failed)
    if rows.size:
        cross = {"symbol": "x", "size": 11, "line": {"width": 0}}
        traces.append(
            {"type": "scatter", "mode": "markers", "showlegend": False, "hoverinfo": "skip", "marker": cross}
            | {"x": columns.tolist(), "y": rows.tolist()}
        )
    return traces


def prints_values(panel: Map, block: Maps) -> bool:
    """Return whether the cells of a map have room for their values."""
    beside = max(1, min(block.columns, len(block.panels)))
    return not panel.contours and beside * len(panel.x_names) <= _MOST_PRINTED


def printed_values(panel: Map, block: Maps) -> list[list[str]]:
    """Return the value that is printed into each cell; nothing into an empty one, nor where a cross stands."""
    low, high = value_range(block)
    digits = digits_between(10.0**low, 10.0**high) if block.log else digits_between(low, high)
    return [
        ["" if np.isnan(value) or failed else number(float(value), digits) if np.isfinite(value) else "never"
         for value, failed in zip(*row, strict=True)]
        for row in zip(panel.values, panel.failed, strict=True)
    ]  # fmt: skip


def _by_rows(values: list[str], columns: int) -> list[list[str]]:
    return [values[start : start + columns] for start in range(0, len(values), columns)]
