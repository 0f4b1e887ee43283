"""Heat maps as Plotly data: one plot per map, one colour scale for all."""

from typing import Any

import numpy as np

from runner.reporting.charts import map_scale
from runner.reporting.charts.axes import map_in_readable_units
from runner.reporting.curves import named_places, neutral
from runner.reporting.document import Map, Maps

Json = dict[str, Any]


def maps_spec(block: Maps) -> list[Json]:
    """Return what the page's script hands to Plotly: for each map traces, palette indices and layout.

    Names of columns and rows go with them, and whether colours follow the logarithm: for keyboards and saved data.
    """
    block = map_in_readable_units(block)
    low, high = map_scale.value_range(block)
    return [_map(panel, block, low, high) for panel in block.panels]


def _map(panel: Map, block: Maps, low: float, high: float) -> Json:
    columns, rows = list(range(len(panel.x_names))), list(range(len(panel.y_names)))
    colors = map_scale.scale_values(panel.values, block.log)
    places, marks = map_scale.scale_marks(block)
    drawn: Json = {
        "type": "contour" if panel.contours else "heatmap",
        "x": columns,
        "y": rows,
        "z": [[None if np.isnan(value) else round(float(value), 9) for value in row] for row in colors],
        "zmin": low,
        "zmax": high,
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
        drawn |= {"ncontours": map_scale.CONTOURS, "line": {"width": 0.7, "color": "#ffffff"}}
    elif max(panel.values.shape) <= map_scale.MOST_PARTED:
        drawn |= {"xgap": 1, "ygap": 1}
    if map_scale.prints_values(panel, block):
        drawn |= {"text": map_scale.printed_values(panel, block), "texttemplate": "%{text}"}
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
    read = {"names": [list(map(neutral, names)) for names in (panel.x_names, panel.y_names)], "log": block.log}
    return {"traces": traces, "colors": [map_scale.OVERLAY] * len(traces), "layout": layout, **read}


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


def _by_rows(values: list[str], columns: int) -> list[list[str]]:
    return [values[start : start + columns] for start in range(0, len(values), columns)]
