"""Numbers as a reader expects them: three digits, a power of ten where it helps, and the unit."""

import math
from collections.abc import Mapping
from typing import Any

ROUNDING = 1e-12
"""What double precision leaves of zero after some operations on lengths, angles and torques of this size."""

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_ROUNDING = "0 (rounding)"
_UNITS = {"1": "", "N^2 m^2 s": "N² m² s", "N^2 s": "N² s", "m/s^2": "m/s²"}


def number(value: float | None, digits: int = 3, rounding: float = 0.0) -> str:
    """Return a number with so many significant digits, such as 0.0735 or 8.73·10⁻³; a dash for a missing one.

    Args:
        value: The number.
        digits: How many digits.
        rounding: What is smaller is rounding of the arithmetic, and said to be that.
    """
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0.0 else "-∞"
    if value == 0.0:
        return "0"
    if 0.0 < abs(value) < rounding:
        return _ROUNDING
    if 1e-2 <= abs(value) < 1e4:
        text = f"{value:.{digits}g}"
        return f"{value:.0f}" if "e" in text else text
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    if value == float(f"{value:.0e}"):
        mantissa = mantissa.partition(".")[0]  # a printed 6·10⁻⁵ claims no more digits than it has
    return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPT)}"


def unit_text(unit: str) -> str:
    """Return a unit as it is set: m/s² for m/s^2, nothing for 1."""
    return _UNITS.get(unit, unit)


def quantity(value: float | None, unit: str, digits: int = 3, rounding: float = 0.0) -> str:
    """Return a number with its unit; rounding has none."""
    text = number(value, digits, rounding)
    if text == _ROUNDING or unit == "°":
        return text if text == _ROUNDING else f"{text}°"
    return f"{text} {unit_text(unit)}".strip()


def above_rounding(value: float | None, unit: str = "1", digits: int = 3) -> str:
    """Return a number with its unit, "0 (rounding)" for one that is of the size of rounding errors, in SI units."""
    return quantity(value, unit, digits, ROUNDING)


def labelled(name: str, unit: str) -> str:
    """Return a name with its unit, as on the axis of a figure."""
    return name if unit == "1" else f"{name} ({unit_text(unit)})"


def digits_between(low: float, high: float) -> int:
    """Return how many digits tell numbers apart that lie between two: three, and more where these are close."""
    largest = max(abs(low), abs(high))
    return 3 if high <= low else min(12, max(3, 2 - math.floor(math.log10((high - low) / largest))))


def spread(metric: Mapping[str, Any]) -> str:
    """Return the median of a stored metric with the range over its repetitions, such as "1.56 s (1.53 to 2.80)"."""
    median = quantity(metric["median"], metric["unit"])
    if len(metric["values"]) < 2 or metric["min"] == metric["max"] is not None:
        return median
    high = "never" if metric["max"] is None else number(metric["max"])
    return f"{median} ({number(metric['min'])} to {high})"
