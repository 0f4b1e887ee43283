"""Number and unit formatting for reports: three significant digits and a fitting unit.

A value of the size of rounding errors is formatted as `0 (rounding)`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

ROUNDING = 1e-12
"""Size of rounding errors in double precision, after several operations on lengths, angles and torques near 1."""

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
ROUNDED = "0 (rounding)"
_EXPONENT = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e[+-]?\d+(?!\w)")
_LABEL_UNIT = re.compile(r"\([^()]*\)$")
_UNITS = {"1": "", "N^2 m^2 s": "N² m² s", "N^2 s": "N² s", "m/s^2": "m/s²"}
# Smallest size, factor and name of each unit; below the last size, the base unit is used with a power of ten.
_SMALLER = {
    "m": ((0.1, 1.0, "m"), (1e-5, 1e3, "mm"), (1e-8, 1e6, "µm")),
    "s": ((0.1, 1.0, "s"), (1e-5, 1e3, "ms"), (1e-8, 1e6, "µs")),
}


def number(
    value: float | None, digits: int = 3, rounding: float = 0.0, zeros: bool = False, plain: float = 1e-2
) -> str:
    """Return a number with significant digits, such as 0.0735 or 8.73·10⁻³; a dash for a missing value.

    Args:
        value: The number.
        digits: Number of significant digits.
        rounding: Smaller absolute values are formatted as rounding errors.
        zeros: True to keep trailing zeros, as in 0.110, for ranges: 0.101 to 0.110.
        plain: Smaller absolute values are formatted with a power of ten; at least 1e-4.
    """
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0.0 else "-∞"
    if value == 0.0:
        return "0"
    if 0.0 < abs(value) < rounding:
        return ROUNDED
    if plain <= abs(value) < 1e4:
        text = f"{value:#.{digits}g}".removesuffix(".") if zeros else f"{value:.{digits}g}"
        return f"{value:.0f}" if "e" in text else text
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    if value == float(f"{value:.0e}") and not zeros:
        mantissa = mantissa.partition(".")[0]  # 6·10⁻⁵ must not suggest more digits
    return f"{mantissa}·10{str(int(exponent)).translate(SUPERSCRIPT)}"


def plain_number(value: float | None) -> str:
    """Return a number with five digits for a terminal, or "-" for a missing value."""
    return "-" if value is None else f"{value:.5g}"


def with_powers(text: str) -> str:
    """Return a string, such as an error message, with numbers in the format of reports: 3.04·10⁻⁴ for 3.04e-04."""
    return _EXPONENT.sub(lambda found: number(float(found[0]), len(found[1].replace(".", "")), ROUNDING), text)


def unit_text(unit: str) -> str:
    """Return a unit as printed: m/s² for m/s^2, an empty string for 1."""
    return _UNITS.get(unit, unit)


def smaller_units(unit: str) -> list[tuple[float, str]]:
    """Return the smaller units of a unit with their factors, such as mm and µm for m; the list can be empty."""
    return [(factor, name) for _, factor, name in _SMALLER.get(unit, ())][1:]


def choose_unit(value: float | None, unit: str) -> tuple[float, str]:
    """Return the factor and the unit of a value: mm below 0.1 m and µm below 0.01 mm; ms and µs for times."""
    size = 0.0 if value is None else abs(value)
    fits = ((factor, name) for least, factor, name in _SMALLER.get(unit, ()) if size >= least and math.isfinite(size))
    return next(fits, (1.0, unit_text(unit)))


def quantity(value: float | None, unit: str, digits: int = 3, rounding: float = 0.0) -> str:
    """Return a number with its unit, such as "8.73 mm"; a rounding error has no unit."""
    factor, name = choose_unit(value, unit)
    plain = 1e-4 if unit == "%" else 1e-2  # percent has no smaller unit to avoid powers of ten
    text = number(value if value is None else factor * value, digits, factor * rounding, plain=plain)
    if text == ROUNDED or unit == "°":
        return text if text == ROUNDED else f"{text}°"
    return f"{text} {name}".strip()


def above_rounding(value: float | None, unit: str = "1", digits: int = 3) -> str:
    """Return a number with its unit, or "0 (rounding)" for a value of the size of rounding errors in SI units."""
    return quantity(value, unit, digits, ROUNDING)


def format_duration(seconds: float) -> str:
    """Return a rounded duration, such as "89 s", "2 min" or "2.5 h"."""
    if seconds < 90.0:
        return f"{max(1, round(seconds))} s"
    if seconds < 5400.0:
        return f"{round(seconds / 60.0)} min"
    return f"{seconds / 3600.0:.1f} h"


def label_with_unit(name: str, unit: str) -> str:
    """Return a name with its unit, as on the axis of a figure."""
    return name if unit == "1" else f"{name} ({unit_text(unit)})"


def bind_label(text: str) -> str:
    """Return a label in which no line break parts the factors of the unit at its end, such as N and m."""
    return _LABEL_UNIT.sub(lambda found: found[0].replace(" ", "\u00a0"), text)


def digits_between(low: float, high: float) -> int:
    """Return the number of digits that distinguishes values in a range: three, or more for a narrow range."""
    largest = max(abs(low), abs(high))
    return 3 if high <= low else min(12, max(3, 2 - math.floor(math.log10((high - low) / largest))))


def format_range(low: float | None, high: float | None, unit: str, word: str = "to") -> str:
    """Return a range with one unit for both ends, such as "7 to 44 mm".

    Args:
        low: The lower end.
        high: The upper end, which determines the unit.
        unit: The SI unit.
        word: Word between the ends.
    """
    factor, name = _shared((low, high), unit, None)
    return f"{_scaled(low, factor)} {word} {_scaled(high, factor)} {name}".strip()


def in_one_unit(values: Sequence[float], unit: str) -> list[str]:
    """Return values with their units: in one unit if none then needs a power of ten, such as "109 mm", "0.0431 mm"."""
    factor, name = _shared(values, unit, None)
    texts = [number(factor * value) for value in values]
    return (
        [f"{text} {name}" for text in texts]
        if not any("·" in text for text in texts)
        else [quantity(value, unit) for value in values]
    )


def with_interval(value: float, half: float) -> tuple[str, str]:
    """Return an estimate and the half width of its interval, both to two digits of the latter: 300.0 and ± 1.1."""
    decimals = max(0, 1 - math.floor(math.log10(half))) if half > 0.0 else 3
    return f"{value:.{decimals}f}", f"± {half:.{decimals}f}"


def spread(
    unit: str, median: float | None, low: float | None, high: float | None, count: int, beside: float | None = None
) -> str:
    """Return the median of a metric with the range over its repetitions, such as "1.56 s (1.53 to 2.80)".

    Args:
        unit: The SI unit.
        median: The median; None if it is infinite.
        low: The smallest value; None if there is none.
        high: The largest value; None if a value is missing.
        count: Number of repetitions.
        beside: A value for comparison; its unit is used unless another one needs fewer powers of ten.
    """
    if count < 2 or low == high is not None:
        factor, name = _shared((median,), unit, median if beside is None else beside)
        return _with_unit(_scaled(median, factor), name)
    middle, ends, _ = with_ends(median, low, math.inf if high is None else high, unit, beside)
    return f"{middle} ({ends})"


def with_ends(
    middle: float | None, low: float | None, high: float | None, unit: str, beside: float | None = None
) -> tuple[str, str, str]:
    """Return a value with its unit, a range around it in the same unit, and that unit: "1.56 s", "1.53 to 2.80", "s".

    Args:
        middle: The value; an infinite value becomes "never".
        low: The lower end of the range; an infinite value becomes "never".
        high: The upper end of the range; an infinite value becomes "never".
        unit: The SI unit.
        beside: A value for comparison; see `spread`.
    """
    known = [value for value in (middle, low, high) if value is not None and math.isfinite(value)]
    chosen = beside if beside is not None else middle if middle is not None and math.isfinite(middle) else None
    factor, name = _shared(known, unit, chosen)
    texts = ["never" if value is not None and math.isinf(value) else _scaled(value, factor, True)
             for value in (middle, low, high)]  # fmt: skip
    return texts[0] if texts[0] == "never" else _with_unit(texts[0], name), f"{texts[1]} to {texts[2]}", name


def fewest_powers(
    values: Iterable[float], units: Sequence[tuple[float, str]], plain: float = 1e-2
) -> tuple[float, str]:
    """Return the first of the units in which the fewest values need a power of ten.

    Args:
        values: The values, in the unit whose factor is 1.
        units: Factors and names of the units.
        plain: Smallest value that needs no power of ten in a unit with another factor.
    """
    numbers = [value for value in values if abs(value) >= ROUNDING]

    def powers(unit: tuple[float, str]) -> int:
        factor, _ = unit
        return sum("·" in number(factor * value, plain=1e-2 if factor == 1.0 else plain) for value in numbers)

    return min(units, key=powers)


def _shared(values: Sequence[float | None], unit: str, beside: float | None) -> tuple[float, str]:
    """Return the unit of a value for comparison, or another unit in which fewer values need powers of ten."""
    known = [value for value in values if value is not None]
    largest = choose_unit(max(map(abs, known), default=None), unit)
    wanted = [choose_unit(beside, unit)] if beside else []
    return fewest_powers(known, [*wanted, largest, *smaller_units(unit)])


def _scaled(value: float | None, factor: float, zeros: bool = False) -> str:
    return number(value if value is None else factor * value, rounding=factor * ROUNDING, zeros=zeros)


def _with_unit(text: str, unit: str) -> str:
    return text if text == ROUNDED else f"{text} {unit}".strip()


def share_of_larger(size: float, small: float, large: float) -> str:
    """Return a difference in per cent of the larger value; 100 % only if the smaller one is 0.

    The result is empty if the larger value is not known or rounding, the smaller one below zero, or the difference
    larger than both.
    """
    if not (math.isfinite(large) and large > ROUNDING and small >= 0.0 and size <= large):
        return ""
    share = 100.0 * size / large
    return f"{number(share, 2) if share < 99.5 else number(share if small == 0.0 else min(share, 99.9), 3)} %"
