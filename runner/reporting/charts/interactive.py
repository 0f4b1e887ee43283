"""Interactive drawings of figures as Plotly data: one plot per panel or map, labels without markup."""

import base64
import html
import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import bind_label
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
    coarsen,
    is_empty,
    shares_legend,
    shifted,
    thin,
    upright,
    usable,
)
from runner.reporting.charts.letters import wrap

Json = dict[str, Any]

_SYMBOLS = ("diamond", "square")  # of points beyond the palette
_MARKS = {"o": "circle", "s": "square", "^": "triangle-up", "D": "diamond", "v": "triangle-down", "P": "cross",
          "X": "x", "<": "triangle-left"}  # fmt: skip
_MODES = {"line": "lines", "dashed": "lines", "dotted": "lines", "points": "markers", "points_line": "lines+markers"}
_DASHES = {"dashed": "dash", "dotted": "dot"}
_LEGEND_WIDTH, _TITLE_WIDTH, _UPRIGHT_WIDTH = 230.0, 260.0, 150.0  # px that a page has for them at least
_LETTERS = 12.0  # px
_NEVER = {"text": NOTHING, "x": 0.5, "y": 0.5, "xref": "paper", "yref": "paper", "showarrow": False}
_WIDTH = 1.7  # px of a line
_POINTS = 500  # of a curve on a page: two for each pixel of a panel
_MOST_NAMES = 16
_FEW_DECADES = 2
_GAP: FloatArray = np.array([np.nan])
_LARGEST = float(np.finfo("<f4").max)
_UNIT = re.compile(r"\(([^(),]+)\)$")


def plotly_spec(figure: Curves | Maps) -> list[Json]:
    """Return the input of Plotly: for each panel or map traces, palette indices and layout.

    If one legend serves all panels, it is below the first of the last row, and what it hides is hidden in all. Maps
    share one colour scale; they also have the names of columns and rows, and whether colours follow the logarithm.
    """
    if isinstance(figure, Maps):
        low, high = scales.value_range(figure)
        return [_map(panel, figure, low, high) for panel in figure.panels]
    shared, below = shares_legend(figure.panels), (len(figure.panels) - 1) // figure.columns * figure.columns
    return [
        _panel(panel) | {"together": shared, "legend": not shared or at == below}
        for at, panel in enumerate(figure.panels)
    ]


def neutral(text: str) -> str:
    """Return a string that Plotly shows literally: it reads tags, entities and formulas in all its strings."""
    return html.escape(plain(text), quote=False).replace("$", "&#36;")


def _panel(panel: Panel) -> Json:
    chosen = palette.indices([series.color for series in panel.series])
    traces: list[Json] = []
    colors: list[int] = []
    for group, series, color in zip(_groups(panel.series), panel.series, chosen, strict=True):
        drawn = [*_band(series, group), _trace(series, group, color) | _hover(panel, series)]
        traces += drawn
        colors += [color] * len(drawn)
    edges = [edge for series in panel.series for edge in (series.low, series.high) if edge is not None]
    heights = [series.y for series in panel.series] + edges
    across = _axis(panel.x_label, panel.x_log, panel.x_range, [series.x for series in panel.series])
    upright = _axis(panel.y_label, panel.y_log, panel.y_range, heights, _UPRIGHT_WIDTH)
    layout = {
        "xaxis": across | _named_places(panel.x_names) if panel.x_names else across,
        "yaxis": upright | _named_places(panel.y_names) if panel.y_names else upright,
        **({"annotations": [_NEVER]} if is_empty(panel) else {}),
        "showlegend": panel.has_legend and any(plain(series.name).strip() for series in panel.series),
        "hovermode": "x unified" if all(map(_compared, panel.series)) else "closest",
    }
    names = {"names_across": list(map(neutral, panel.x_names))} if panel.x_names else {}
    return {"traces": traces, "colors": colors, "layout": layout, **names}


def _groups(curves: Sequence[Series]) -> list[int]:
    """Return the group of each curve, which a click on a legend entry hides.

    A named curve without points is a key: its group has the nameless curves of its style, too.
    """
    keys = {series.style: number for number, series in enumerate(curves) if series.name and not series.x.size}
    return [number if series.name else keys.get(series.style, number) for number, series in enumerate(curves)]


def _named_places(names: Sequence[str]) -> Json:
    """Return an axis with names at the places 0, 1, ...; of many, every other one and so on."""
    step = -(-len(names) // _MOST_NAMES) or 1
    return {
        "tickmode": "array",
        "tickvals": list(range(0, len(names), step)),
        "ticktext": [neutral(name) for name in names[::step]],
        "autotickangles": [0, -35, -90],  # turned names end at their place, which leaves room for the last one
        "range": [-0.5, len(names) - 0.5],
    }


def _trace(series: Series, group: int, color: int) -> Json:
    rounds, look = palette.rounds(color), color % len(palette.MARKS)
    symbol = _MARKS[palette.MARKS[look]] if series.level else _SYMBOLS[min(rounds, len(_SYMBOLS)) - 1] if rounds else ""
    dash = _DASHES.get(series.style, "solid")
    if series.level and series.style not in _DASHES and palette.DASHES[look]:
        dash = ",".join(f"{_WIDTH * length:.3g}px" for length in palette.DASHES[look])
    thinned = coarsen(thin(series, _POINTS))
    drawn = shifted(thinned)
    name = plain(series.name).strip()
    pointed: Json = {"zorder": 1} if series.style in _DASHES else {}  # so that it is seen on a curve without breaks
    if series.label:
        texts = [*[""] * (thinned.x.size - 1), neutral(series.label)]
        pointed |= {
            "mode": "lines+text",
            "cliponaxis": False,
            "text": texts,
            "textposition": "top right" if upright(series) else "top left",
            "textfont": {"size": 10},
        }
    if series.hints:
        pointed |= {"text": [neutral(hint) for hint in thinned.hints], "hoverinfo": "text"}
    if series.runs:
        pointed["customdata"] = list(thinned.runs)
    return {
        "type": "scatter",
        "mode": _MODES[series.style],
        "name": _lines(name, _LEGEND_WIDTH),
        "showlegend": bool(name),
        "legendgroup": str(group),
        "line": {"dash": dash, "width": _WIDTH},
        "marker": {"size": 6} | ({"symbol": symbol} if symbol else {}),
        # Plotly has no legend entry for a curve without points: a gap is a point.
        "x": _typed(drawn.x if drawn.x.size else _GAP),
        "y": _typed(drawn.y if drawn.x.size else _GAP),
        **pointed,
        **_data(thinned),
    }


def _data(series: Series) -> Json:
    """Return the data of a curve that are saved with its points: places of shifted points, ends of its band."""
    parts = {"x": series.x if series.shift is not None else None, "low": series.low, "high": series.high}
    found = {name: _typed(part) for name, part in parts.items() if part is not None}
    return {"meta": found} if found else {}


def _hover(panel: Panel, series: Series) -> Json:
    """Return the text at the pointer for a point without a hint: its numbers with their units."""
    if series.hints:
        return {}
    y = f"%{{y:.4~g}}{_unit(panel.y_label)}"
    if _compared(series):
        return {"hovertemplate": y}  # x is above all curves
    return {"hovertemplate": f"%{{x:.4~g}}{_unit(panel.x_label)}, {y}"}


def _unit(label: str) -> str:
    """Return the unit at the end of an axis' label, after a space; nothing where there is none."""
    found = _UNIT.search(plain(label))
    return f" {neutral(found[1])}" if found else ""


def _band(series: Series, group: int) -> list[Json]:
    thinned = shifted(thin(series, _POINTS))
    upright_bars = bars(thinned)
    outline = upright_bars or band(thinned)
    if outline is None:
        return []
    return [
        {
            "type": "scatter",
            "mode": "lines",
            **({} if upright_bars else {"fill": "toself"}),
            "hoverinfo": "skip",
            "showlegend": False,
            "legendgroup": str(group),
            "line": {"width": _WIDTH if upright_bars else 0},
            "x": _typed(outline[0]),
            "y": _typed(outline[1]),
        }
    ]


def _axis(
    label: str, log: bool, limits: tuple[float, float] | None, values: list[FloatArray], width: float = _TITLE_WIDTH
) -> Json:
    title = {"text": _lines(label, width)}
    axis: Json = {"title": title, "type": "log" if log else "linear", "hoverformat": ".5~g"}
    shown = limits if limits is not None and usable(limits, log) else None
    if shown is not None:
        axis["range"] = [math.log10(limit) if log else float(limit) for limit in shown]
    return axis | _marks(shown, values) if log else axis


def _marks(shown: tuple[float, float] | None, values: list[FloatArray]) -> Json:
    """Return the marks of a logarithmic axis: powers of ten, at most about ten; 2 and 5 between few of them."""
    everything = np.concatenate(
        [np.ravel(given) for given in (values if shown is None else [np.array(shown)])] or [np.zeros(0)]
    )
    positive = everything[np.isfinite(everything) & (everything > 0)]
    if not positive.size:
        return {}
    first, last = math.floor(np.log10(positive.min())), math.ceil(np.log10(positive.max()))
    between = (1, 2, 5) if last - first <= _FEW_DECADES else (1,)
    places = [step * 10.0**power for power in range(first, last + 1, math.ceil((last - first) / 10) or 1)
              for step in between]  # fmt: skip
    write = scales.marks(places[0], places[-1], log=True)
    return {"tickmode": "array", "tickvals": places, "ticktext": [write(place) for place in places]}


def _lines(text: str, width: float) -> str:
    """Return a string broken into lines of a width, in px, which Plotly does not do by itself."""
    return "<br>".join(neutral(line) for line in wrap(bind_label(plain(text).strip()), width, _LETTERS))


def _compared(series: Series) -> bool:
    """Return True if curves are read at one x: the abscissae never go back, and no point has its own hint."""
    return not series.hints and not np.any(np.diff(series.x[np.isfinite(series.x)]) < 0)


def _typed(values: FloatArray) -> Json:
    # A value beyond single precision overflows the autorange; NaN is a gap.
    finite = np.where(np.abs(values) <= _LARGEST, values, np.nan)
    return {"dtype": "f4", "bdata": pack(finite)}


def pack(values: FloatArray) -> str:
    """Return numbers in single precision as base64, which the page's scripts unpack."""
    return base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode("ascii")


def _map(panel: Map, block: Maps, low: float, high: float) -> Json:
    columns, rows = list(range(len(panel.x_names))), list(range(len(panel.y_names)))
    colors = scales.scale_values(panel.values, block.log)
    places, marks = scales.scale_marks(block)
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
        drawn |= {"ncontours": scales.CONTOURS, "line": {"width": 0.7, "color": "#ffffff"}}
    elif max(panel.values.shape) <= scales.MOST_PARTED:
        drawn |= {"xgap": 1, "ygap": 1}
    if scales.prints_values(panel, block):
        drawn |= {"text": scales.printed_values(panel, block), "texttemplate": "%{text}"}
    if panel.hints:
        drawn |= {
            "hovertext": np.reshape(list(map(neutral, panel.hints)), panel.values.shape).tolist(),
            "hoverinfo": "text",
        }
    if panel.runs:
        drawn["customdata"] = np.reshape(panel.runs, panel.values.shape).tolist()
    traces = [drawn, *_overlay(panel)]
    layout = {
        "xaxis": {"title": {"text": neutral(panel.x_label)}, **_named_places(panel.x_names)},
        "yaxis": {"title": {"text": neutral(panel.y_label)}, **_named_places(panel.y_names)},
        "showlegend": any(series.name for series in panel.lines),
        "hovermode": "closest",
    }
    read = {"names": [list(map(neutral, names)) for names in (panel.x_names, panel.y_names)], "log": block.log}
    return {"traces": traces, "colors": [scales.OVERLAY] * len(traces), "layout": layout, **read}


def _overlay(panel: Map) -> list[Json]:
    """Return the overlay of the cells: curves, and crosses on failed cells."""
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
