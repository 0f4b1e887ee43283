"""Axes in readable units, such as mm below 0.1 m, and their tick labels in one notation."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import SUPERSCRIPT, choose_unit
from runner.reporting.charts.figure import Maps, Panel, Series

_UNIT = re.compile(r"\((m|s)\)$")
_SMALLEST, _LARGEST = 1e-3, 1e4  # of what is written without a power of ten
Mark = Callable[[float], str]


def in_readable_units(panels: Sequence[Panel], columns: int) -> list[Panel]:
    """Return the panels with lengths and times in the unit that fits the largest of them.

    Panels that stand beside each other and have one label keep one unit, so that they can be compared.

    Args:
        panels: The panels in reading order.
        columns: How many stand beside each other.
    """
    rows = [panels[start : start + columns] for start in range(0, len(panels), max(1, columns))]
    return [_in_unit(_in_unit(panel, row, "x"), row, "y") for row in rows for panel in row]


def map_in_readable_units(figure: Maps) -> Maps:
    """Return a figure of maps with values that are lengths or times in the unit that fits the largest."""
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
    return replace(figure, value_label=label, panels=panels)


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


def marks(low: float, high: float, log: bool = False) -> Mark:
    """Return what writes the labels of an axis that goes from one value to another.

    They are plain decimals where the largest of them is from 0.001 to 10,000; on a logarithmic axis the smallest, too.
    """
    ends = (abs(low), abs(high))
    small = min(ends) if log else max(ends)
    return plain_mark if small >= 0.999 * _SMALLEST and max(ends) <= 1.001 * _LARGEST else power_mark


def plain_mark(value: float) -> str:
    """Return a value in as many decimals as it needs, such as 0.05."""
    text = f"{float(f'{value:.6g}'):.12f}".rstrip("0").rstrip(".")  # a locator's 0.3 is off by rounding
    return "0" if text in ("-0", "") else text


def power_mark(value: float) -> str:
    """Return a value with a power of ten, such as 5·10⁻⁴."""
    if value == 0.0:
        return "0"
    value = float(f"{value:.6g}")
    digits = next(count for count in range(6) if math.isclose(float(f"{value:.{count}e}"), value, rel_tol=1e-6))
    mantissa, _, exponent = f"{value:.{digits}e}".partition("e")
    return f"{mantissa}·10{str(int(exponent)).translate(SUPERSCRIPT)}".replace("-1·10", "-10").removeprefix("1·")


def at_2_and_5(write: Mark) -> Mark:
    """Return what labels the marks between two powers of ten: at 2 and 5 alone."""
    return lambda value: write(value) if f"{value:.0e}"[0] in "25" else ""
