"""Number and unit formatting for reports: three significant digits and a fitting unit.

A value of the size of rounding errors is formatted as `0 (rounding)`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

ROUNDING = 1e-12
"""What double precision leaves of zero after some operations on lengths, angles and torques of this size."""

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
ROUNDED = "0 (rounding)"
_EXPONENT = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e[+-]?\d+(?!\w)")
_UNITS = {"1": "", "N^2 m^2 s": "N² m² s", "N^2 s": "N² s", "m/s^2": "m/s²"}
# From which size on a unit is taken, with its factor; below the last one the unit itself, with a power of ten.
_SMALLER = {
    "m": ((0.1, 1.0, "m"), (1e-5, 1e3, "mm"), (1e-8, 1e6, "µm")),
    "s": ((0.1, 1.0, "s"), (1e-5, 1e3, "ms"), (1e-8, 1e6, "µs")),
}


class Shown(str):
    """A number as text that remembers what it shows, so that a column of a table can be given one unit.

    Attributes:
        value: The number.
        digits: How many digits it has.
    """

    __slots__ = ("digits", "value")
    value: float
    digits: int

    def __new__(cls, text: str, value: float, digits: int) -> Shown:
        """Return the text with its number."""
        shown = super().__new__(cls, text)
        shown.value, shown.digits = value, digits
        return shown


def number(
    value: float | None, digits: int = 3, rounding: float = 0.0, zeros: bool = False, plain: float = 1e-2
) -> str:
    """Return a number with so many significant digits, such as 0.0735 or 8.73·10⁻³; a dash for a missing one.

    Args:
        value: The number.
        digits: How many digits.
        rounding: What is smaller is rounding of the arithmetic, and said to be that.
        zeros: Whether zeros at the end stay, as in 0.110, which a range needs: 0.101 to 0.110.
        plain: What is smaller has a power of ten; 1e-4 or more.
    """
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0.0 else "-∞"
    if value == 0.0:
        return Shown("0", 0.0, digits)
    if 0.0 < abs(value) < rounding:
        return ROUNDED
    return Shown(_text(value, digits, zeros, plain), value, digits)


def plain_number(value: float | None) -> str:
    """Return a number with five digits for a terminal, or "-" if there is none."""
    return "-" if value is None else f"{value:.5g}"


def _text(value: float, digits: int, zeros: bool, plain: float) -> str:
    if plain <= abs(value) < 1e4:
        text = f"{value:#.{digits}g}".removesuffix(".") if zeros else f"{value:.{digits}g}"
        return f"{value:.0f}" if "e" in text else text
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    if value == float(f"{value:.0e}") and not zeros:
        mantissa = mantissa.partition(".")[0]  # a printed 6·10⁻⁵ claims no more digits than it has
    return f"{mantissa}·10{str(int(exponent)).translate(SUPERSCRIPT)}"


def with_powers(text: str) -> str:
    """Return a text, such as an error message, with its numbers as a report writes them: 3.04·10⁻⁴ for 3.04e-04."""
    return _EXPONENT.sub(lambda found: number(float(found[0]), len(found[1].replace(".", "")), ROUNDING), text)


def unit_text(unit: str) -> str:
    """Return a unit as it is set: m/s² for m/s^2, nothing for 1."""
    return _UNITS.get(unit, unit)


def smaller_units(unit: str) -> list[tuple[float, str]]:
    """Return the smaller units of a unit with their factors, mm and µm for m; none where there are none."""
    return [(factor, name) for _, factor, name in _SMALLER.get(unit, ())][1:]


def choose_unit(value: float | None, unit: str) -> tuple[float, str]:
    """Return the factor and the unit in which a value is shown: mm below 0.1 m, µm below 0.01 mm; ms and µs alike."""
    size = 0.0 if value is None else abs(value)
    fits = ((factor, name) for least, factor, name in _SMALLER.get(unit, ()) if size >= least and math.isfinite(size))
    return next(fits, (1.0, unit_text(unit)))


def quantity(value: float | None, unit: str, digits: int = 3, rounding: float = 0.0) -> str:
    """Return a number with its unit, such as "8.73 mm"; what is rounding has none."""
    factor, name = choose_unit(value, unit)
    plain = 1e-4 if unit == "%" else 1e-2  # per cent have no smaller unit that spares a power of ten
    text = number(value if value is None else factor * value, digits, factor * rounding, plain=plain)
    if text == ROUNDED or unit == "°":
        return text if text == ROUNDED else f"{text}°"
    return f"{text} {name}".strip()


def above_rounding(value: float | None, unit: str = "1", digits: int = 3) -> str:
    """Return a number with its unit, "0 (rounding)" for one that is of the size of rounding errors, in SI units."""
    return quantity(value, unit, digits, ROUNDING) if unit != "1" else number(value, digits, ROUNDING)


def format_duration(seconds: float) -> str:
    """Return a duration for people, such as "89 s", "2 min" or "2.5 h"."""
    if seconds < 90.0:
        return f"{max(1, round(seconds))} s"
    if seconds < 5400.0:
        return f"{round(seconds / 60.0)} min"
    return f"{seconds / 3600.0:.1f} h"


def label_with_unit(name: str, unit: str) -> str:
    """Return a name with its unit, as on the axis of a figure."""
    return name if unit == "1" else f"{name} ({unit_text(unit)})"


def digits_between(low: float, high: float) -> int:
    """Return how many digits tell numbers apart that lie between two: three, and more where these are close."""
    largest = max(abs(low), abs(high))
    return 3 if high <= low else min(12, max(3, 2 - math.floor(math.log10((high - low) / largest))))


def format_range(low: float | None, high: float | None, unit: str, beside: float | None = None) -> str:
    """Return a range with its unit, both ends in the same one, such as "7 to 44 mm".

    Args:
        low: The lower end.
        high: The upper end, which decides about the unit.
        unit: The SI unit.
        beside: A value that it is compared with; its unit is taken where no end needs a power of ten in it.
    """
    factor, name = _shared((low, high), unit, beside)
    return f"{_scaled(low, factor)} to {_scaled(high, factor)} {name}".strip()


def with_interval(value: float, half: float) -> tuple[str, str]:
    """Return an estimate and the half width of its interval, both to the second digit of that: 300.0 and ± 1.1."""
    decimals = max(0, 1 - math.floor(math.log10(half))) if half > 0.0 else 3
    return f"{value:.{decimals}f}", f"± {half:.{decimals}f}"


def spread(
    unit: str, median: float | None, low: float | None, high: float | None, count: int, beside: float | None = None
) -> str:
    """Return the median of a metric with the range over its repetitions, such as "1.56 s (1.53 to 2.80)".

    Args:
        unit: The SI unit.
        median: The median; None if it is beyond every number.
        low: The smallest value; None if there is none.
        high: The largest value; None if a value is missing.
        count: Number of repetitions.
        beside: A printed value next to which the text stands; its unit is used. See `ranged`.
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
        middle: The value; an infinite one is "never".
        low: The lower end of the range, likewise.
        high: The upper end, likewise.
        unit: The SI unit.
        beside: A value that they are compared with, of which they take the unit; see `ranged`.
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
    """Return the unit, of some with their factors, in which the fewest values need a power of ten; the first such.

    Args:
        values: The values, in the unit whose factor is 1.
        units: The units.
        plain: From where on values in one of the other units need none.
    """
    numbers = [value for value in values if abs(value) >= ROUNDING]

    def powers(unit: tuple[float, str]) -> int:
        factor, _ = unit
        return sum("·" in number(factor * value, plain=1e-2 if factor == 1.0 else plain) for value in numbers)

    return min(units, key=powers)


def _shared(values: Sequence[float | None], unit: str, beside: float | None) -> tuple[float, str]:
    """Return the unit of a value that some others are compared with, or another one in which these need no powers."""
    known = [value for value in values if value is not None]
    largest = choose_unit(max(map(abs, known), default=None), unit)
    wanted = [choose_unit(beside, unit)] if beside else []
    return fewest_powers(known, [*wanted, largest, *smaller_units(unit)])


def _scaled(value: float | None, factor: float, zeros: bool = False) -> str:
    return number(value if value is None else factor * value, rounding=factor * ROUNDING, zeros=zeros)


def _with_unit(text: str, unit: str) -> str:
    return text if text == ROUNDED else f"{text} {unit}".strip()
