"""Numbers as a reader expects them: three digits, a power of ten where it helps, and the unit."""

from collections.abc import Mapping
from typing import Any

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_UNITS = {"1": "", "N^2 m^2 s": "N² m² s", "N^2 s": "N² s", "m/s^2": "m/s²"}


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with so many significant digits, such as 0.0735 or 8.73·10⁻³; a dash for a missing one."""
    if value is None:
        return "–"
    if value == 0.0:
        return "0"
    if 1e-2 <= abs(value) < 1e4:
        text = f"{value:.{digits}g}"
        return f"{value:.0f}" if "e" in text else text
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    if value == float(f"{value:.0e}"):
        mantissa = mantissa.partition(".")[0]  # a printed 6·10⁻⁵ claims no more digits than it has
    return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPT)}"


def quantity(value: float | None, unit: str, digits: int = 3) -> str:
    """Return a number with its unit."""
    return f"{number(value, digits)} {_UNITS.get(unit, unit)}".strip()


def spread(metric: Mapping[str, Any]) -> str:
    """Return the median of a stored metric with the range over its repetitions, such as "1.56 s (1.53 to 2.80)"."""
    median = quantity(metric["median"], metric["unit"])
    if len(metric["values"]) < 2 or metric["min"] == metric["max"] is not None:
        return median
    high = "never" if metric["max"] is None else number(metric["max"])
    return f"{median} ({number(metric['min'])} to {high})"
