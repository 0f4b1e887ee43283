"""Number format of table columns: one unit per column, digits from the confidence interval."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import ROUNDING, choose_unit, fewest_powers, smaller_units
from runner.statistics import Interval, median_interval

_SMALLEST, _LARGEST = 1e-2, 1e5  # outside of these the head of a column has a power of ten
_PLAIN = 1e-4  # in a smaller unit, such as mm, plain decimals are read down to this
_DIGITS = 3  # of a number without interval
_MOST_DIGITS = 6
BEYOND, MISSING = "∞", "–"


class Unit(str):
    """A unit of a metric, such as "mm", "N m" or "m/s^2", with a power of ten before it.

    Attributes:
        power: The exponent; 0 for none.
    """

    __slots__ = ("power",)
    power: int

    def __new__(cls, text: str, power: int = 0) -> "Unit":
        """Return a unit."""
        unit = super().__new__(cls, text)
        unit.power = power
        return unit


@dataclass(frozen=True)
class Cell:
    """A median with its interval as strings; no ends if the sample is too small for one, or all values are the same.

    Attributes:
        median: The median; "∞" where it lies beyond every number, "–" without a value.
        low: Lower end, or "".
        high: Upper end, or "".
        n: Number of values.
        lost: How many of these lie beyond every number.
        rounding: True if it is what rounding leaves of zero.
        alike: True if all values are the same.
    """

    median: str
    low: str
    high: str
    n: int
    lost: int
    rounding: bool
    alike: bool


@dataclass(frozen=True)
class Column:
    """A metric in all rows.

    Attributes:
        title: What it is.
        unit: Its unit.
        cells: One for each row.
    """

    title: str
    unit: Unit
    cells: Sequence[Cell]

    @property
    def has_intervals(self) -> bool:
        """True if any of its cells has an interval."""
        return any(cell.low for cell in self.cells)


def column(title: str, unit: str, samples: FloatArray) -> Column:
    """Return a metric in all rows, in the unit that fits all of them.

    Args:
        title: What it is.
        unit: Its SI unit.
        samples: Its values, shape (rows, values): infinite beyond every number, NaN where there is none.
    """
    present = [row[~np.isnan(row)] for row in samples]
    found = [median_interval(values) if len(values) else None for values in present]
    shown = [value for each in found if each is not None for value in (each.median, each.low, each.high)
             if value is not None and math.isfinite(value) and abs(value) >= ROUNDING]  # fmt: skip
    largest = max(map(abs, shown), default=0.0)
    factor, name = fewest_powers(shown, [choose_unit(largest, unit), *smaller_units(unit)], _PLAIN)
    power = _power(factor * largest)
    scale = factor * 10.0**-power
    lost = np.isinf(samples).sum(axis=1)
    cells = [_cell(each, scale, int(count)) for each, count in zip(found, lost, strict=True)]
    return Column(title, Unit(unit if factor == 1.0 else name, power), cells)


def _power(largest: float) -> int:
    """Return the power of ten of a column, a multiple of three; 0 where its numbers are read without."""
    if largest == 0.0 or _SMALLEST <= largest < _LARGEST:
        return 0
    return 3 * math.floor(math.log10(largest) / 3)


def _cell(found: Interval | None, scale: float, lost: int) -> Cell:
    if found is None:
        return Cell(MISSING, "", "", 0, 0, False, False)
    alike = found.low is not None and found.low == found.high
    if alike:
        found = replace(found, low=None, high=None)
    ends = [value for value in (found.median, found.low, found.high) if value is not None]
    if all(abs(value) < ROUNDING for value in ends):
        zero = "0" if found.low is not None else ""
        return Cell("0", zero, zero, found.n, lost, any(ends), alike)
    places = decimals(scale * found.median, *(None if end is None else scale * end for end in (found.low, found.high)))
    low, high = ("" if end is None else _text(scale * end, places) for end in (found.low, found.high))
    return Cell(_text(scale * found.median, places), low, high, found.n, lost, False, alike)


def decimals(median: float, low: float | None, high: float | None) -> int:
    """Return to how many decimals a median is given: to the second digit of the half width of its interval.

    At most six digits; three without an interval.
    """
    finite = [value for value in (low, median, high) if value is not None and math.isfinite(value)]
    half = (max(finite) - min(finite)) / (2.0 if len(finite) == 3 else 1.0) if finite else 0.0
    size = max(map(abs, finite), default=0.0)
    if size == 0.0:
        return 0
    leading = math.floor(math.log10(size))
    wanted = 1 - math.floor(math.log10(half)) if half > 0.0 else _DIGITS - 1 - leading
    return max(0, min(wanted, _MOST_DIGITS - 1 - leading))


def _text(value: float, places: int) -> str:
    if math.isinf(value):
        return BEYOND if value > 0 else f"-{BEYOND}"
    text = f"{value:.{places}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text
