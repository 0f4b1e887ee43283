"""Axes in readable units: mm for errors below 0.1 m, ms for times below 0.1 s."""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import choose_unit
from runner.reporting.charts.figure import MapFigure, Panel, Series

MapOf = TypeVar("MapOf", bound=MapFigure)
_UNIT = re.compile(r"\((m|s)\)$")


def in_readable_units(panels: Sequence[Panel], columns: int) -> list[Panel]:
    """Return the panels with lengths and times in the unit that fits the largest of them.

    Panels that stand beside each other and have one label keep one unit, so that they can be compared.

    Args:
        panels: The panels in reading order.
        columns: How many stand beside each other.
    """
    rows = [panels[start : start + columns] for start in range(0, len(panels), max(1, columns))]
    return [_in_unit(_in_unit(panel, row, "x"), row, "y") for row in rows for panel in row]


def map_in_readable_units(figure: MapOf) -> MapOf:
    """Return a figure of maps, a dataclass, with values that are lengths or times in the unit that fits the largest."""
    found = _UNIT.search(figure.value_label)
    if found is None:
        return figure
    values = np.concatenate([np.zeros(1), *(panel.values.ravel() for panel in figure.panels)])
    factor, unit = choose_unit(float(np.abs(values[np.isfinite(values)]).max()), found[1])
    panels = [
        replace(
            panel,
            **{name: factor * part for name in ("values", "low", "high") if (part := getattr(panel, name)) is not None},
        )
        for panel in figure.panels
    ]
    label = f"{figure.value_label[: found.start()]}({unit})"
    scaled: MapOf = replace(figure, value_label=label, panels=panels)  # type: ignore[type-var]
    return scaled


def _in_unit(panel: Panel, row: Sequence[Panel], axis: str) -> Panel:
    label: str = getattr(panel, f"{axis}_label")
    found = _UNIT.search(label)
    if found is None or (axis == "x" and panel.x_names):
        return panel
    alike = [each for each in row if getattr(each, f"{axis}_label") == label]
    factor, name = choose_unit(max(_largest(each, axis) for each in alike), found[1])
    if factor == 1.0:
        return panel
    limits = getattr(panel, f"{axis}_range")
    changed: dict[str, Any] = {
        f"{axis}_label": f"{label[: found.start()]}({name})",
        f"{axis}_range": limits and tuple(factor * limit for limit in limits),
        "series": [_scaled(series, axis, factor) for series in panel.series],
    }
    return replace(panel, **changed)


def _largest(panel: Panel, axis: str) -> float:
    limits = getattr(panel, f"{axis}_range")
    if limits is not None:
        return float(np.abs(limits).max())
    values = [np.abs(each[np.isfinite(each)]) for series in panel.series for each in _channels(series, axis).values()]
    return float(np.concatenate([np.zeros(1), *values]).max())


def _channels(series: Series, axis: str) -> dict[str, FloatArray]:
    edges = {"low": series.low, "high": series.high} if axis == "y" else {}
    return {axis: getattr(series, axis), **{name: edge for name, edge in edges.items() if edge is not None}}


def _scaled(series: Series, axis: str, factor: float) -> Series:
    changed: dict[str, Any] = {name: factor * values for name, values in _channels(series, axis).items()}
    return replace(series, **changed)
