"""Scales of figures: axes in readable units such as mm, tick labels in one notation, and colours of maps."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import choose_unit, digits_between, number
from runner.reporting.charts.figure import Curves, Map, Maps, Panel, Series

OVERLAY = 1
"""Palette index of what lies over the cells, red, which their colours do not hold."""
CONTOURS = 10
"""About how many lines of equal value a map shows."""
MOST_PARTED = 20
"""Most cells side by side that are parted by white lines."""
EQUAL = 0.02
"""Share of the largest value below which a difference is not to fill a scale."""
_SMALLEST_PRINTED = 1e-4  # value without a power of ten
_MOST_PRINTED = 10  # cells side by side whose values can be read
_UNIT = re.compile(r"\((m|s)\)$")
_SMALLEST, _LARGEST = 1e-3, 1e4  # of what is written without a power of ten
_CHANNELS = {"x": ("x",), "y": ("y", "low", "high"), "value": ("values", "low", "high")}
Drawn = TypeVar("Drawn", Series, Map)
Mark = Callable[[float], str]


def curves_in_readable_units(figure: Curves) -> Curves:
    """Return a figure with lengths and times in the unit that fits the largest of them.

    Panels that are side by side and have one label keep one unit, so that they can be compared.
    """
    step = max(1, figure.columns)
    rows = [figure.panels[start : start + step] for start in range(0, len(figure.panels), step)]
    return replace(figure, panels=[_in_unit(_in_unit(panel, row, "x"), row, "y") for row in rows for panel in row])


def maps_in_readable_units(figure: Maps) -> Maps:
    """Return a figure of maps with values that are lengths or times in the unit that fits the largest."""
    found = _UNIT.search(figure.value_label)
    if found is None:
        return figure
    values = np.concatenate([np.zeros(1), *(panel.values.ravel() for panel in figure.panels)])
    factor, unit = choose_unit(float(np.abs(values[np.isfinite(values)]).max()), found[1])
    panels = [_scaled(panel, "value", factor) for panel in figure.panels]
    return replace(figure, value_label=f"{figure.value_label[: found.start()]}({unit})", panels=panels)


def _in_unit(panel: Panel, row: Sequence[Panel], axis: str) -> Panel:
    label: str = getattr(panel, f"{axis}_label")
    found = _UNIT.search(label)
    if found is None or (axis == "x" and panel.x_names) or (axis == "y" and panel.y_names):
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


def _channels(shown: Series | Map, axis: str) -> dict[str, FloatArray]:
    return {name: part for name in _CHANNELS[axis] if (part := getattr(shown, name)) is not None}


def _scaled(shown: Drawn, axis: str, factor: float) -> Drawn:
    changed: dict[str, Any] = {name: factor * values for name, values in _channels(shown, axis).items()}
    return replace(shown, **changed)


def marks(low: float, high: float, log: bool) -> Mark:
    """Return the function that writes the labels of an axis that goes from one value to another.

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
    digits = next(count for count in range(1, 7) if math.isclose(float(f"{value:.{count - 1}e}"), value, rel_tol=1e-6))
    return number(value, digits, plain=math.inf).replace("-1·10", "-10").removeprefix("1·")


def at_2_and_5(write: Mark) -> Mark:
    """Return the function that labels the marks between two powers of ten, at 2 and 5 only."""
    return lambda value: write(value) if f"{value:.0e}"[0] in "25" else ""


def scale_values(values: FloatArray, log: bool) -> FloatArray:
    """Return the coloured quantity: the values or their logarithms, NaN where there is none."""
    if not log:
        return np.where(np.isfinite(values), values, np.nan)
    positive = np.isfinite(values) & (values > 0)
    return np.log10(values, out=np.full(values.shape, np.nan), where=positive)


def value_range(figure: Maps) -> tuple[float, float]:
    """Return the ends of the scale of colours, as scaled.

    The scale spans the intervals of the values and at least 2 % of the largest one, so that full contrast shows a
    real difference.
    """
    parts = [part for panel in figure.panels for part in (panel.values, panel.low, panel.high) if part is not None]
    everything = np.concatenate([np.zeros(0), *(scale_values(part, figure.log).ravel() for part in parts)])
    finite = everything[np.isfinite(everything)]
    if not finite.any():
        return (0.0, 1.0)
    low, high = float(finite.min()), float(finite.max())
    return widen_range(low, high, -math.log10(1.0 - EQUAL) if figure.log else EQUAL * max(abs(low), abs(high)))


def widen_range(low: float, high: float, least: float) -> tuple[float, float]:
    """Return a range about the same middle that is at least so wide."""
    room = 0.5 * max(0.0, least - (high - low))
    return low - room, high + room


def scale_marks(figure: Maps) -> tuple[list[float], list[str]]:
    """Return the marks of the scale of colours: places, as scaled, and values."""
    low, high = value_range(figure)
    places = np.linspace(low, high, 5)
    values = 10.0**places if figure.log else places
    digits = digits_between(values[0], values[-1])
    plain = _plain(values)
    return places.tolist(), [number(float(value), digits, plain=plain) for value in values]


def prints_values(panel: Map, figure: Maps) -> bool:
    """Return True if the cells of a map have room for their values."""
    beside = max(1, min(figure.columns, len(figure.panels)))
    return not panel.contours and beside * len(panel.x_names) <= _MOST_PRINTED


def printed_values(panel: Map, figure: Maps) -> list[list[str]]:
    """Return the value that is printed into each cell; nothing into an empty one, nor into a failed one."""
    low, high = value_range(figure)
    digits = digits_between(10.0**low, 10.0**high) if figure.log else digits_between(low, high)
    plain = _plain(np.concatenate([each.values.ravel() for each in figure.panels]))
    return [
        ["" if np.isnan(value) or failed else
         number(float(value), digits, plain=plain) if np.isfinite(value) else "never"
         for value, failed in zip(*row, strict=True)]
        for row in zip(panel.values, panel.failed, strict=True)
    ]  # fmt: skip


def _plain(values: FloatArray) -> float:
    """Return from where on values are decimals, so that all of them have one notation: none if not each can be."""
    sizes = np.abs(values[np.isfinite(values) & (values != 0.0)])
    return (
        _SMALLEST_PRINTED
        if sizes.size == 0 or (sizes.min() >= _SMALLEST_PRINTED and sizes.max() < _LARGEST)
        else math.inf
    )
