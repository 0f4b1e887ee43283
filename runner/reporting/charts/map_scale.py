"""Colour scales of heat maps: range, marks and printed cell values."""

import math

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import digits_between, number
from runner.reporting.charts.figure import Map, Maps

OVERLAY = 1
"""Palette index of what lies over the cells, red, which their colours do not hold."""
CONTOURS = 10
"""About how many lines of equal value a map shows."""
MOST_PARTED = 20
"""Most cells beside each other that are parted by white lines."""
EQUAL = 0.02
"""Share of the largest value below which a difference is not to fill a scale."""
_SMALLEST, _LARGEST = 1e-4, 1e4  # of values without a power of ten
_MOST_PRINTED = 10  # cells beside each other whose values can be read


def scale_values(values: FloatArray, log: bool) -> FloatArray:
    """Return what the colours follow: the values or their logarithms, NaN where there is none."""
    if not log:
        return np.where(np.isfinite(values), values, np.nan)
    positive = np.isfinite(values) & (values > 0)
    return np.log10(values, out=np.full(values.shape, np.nan), where=positive)


def value_range(figure: Maps) -> tuple[float, float]:
    """Return the ends of the scale of colours, as scaled.

    The scale spans the intervals of the values and at least 2 % of the largest one, so that full contrast stands for a
    difference that can be told.
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
    """Return where the scale of colours is marked, as scaled, and with which values."""
    low, high = value_range(figure)
    places = np.linspace(low, high, 5)
    values = 10.0**places if figure.log else places
    digits = digits_between(values[0], values[-1])
    plain = _plain(values)
    return places.tolist(), [number(float(value), digits, plain=plain) for value in values]


def prints_values(panel: Map, figure: Maps) -> bool:
    """Return whether the cells of a map have room for their values."""
    beside = max(1, min(figure.columns, len(figure.panels)))
    return not panel.contours and beside * len(panel.x_names) <= _MOST_PRINTED


def printed_values(panel: Map, figure: Maps) -> list[list[str]]:
    """Return the value that is printed into each cell; nothing into an empty one, nor where a cross stands."""
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
    return _SMALLEST if sizes.size == 0 or (sizes.min() >= _SMALLEST and sizes.max() < _LARGEST) else math.inf
