"""Tick labels of an axis in one notation: 0.0005 and 0.001, or 5·10⁻⁴ and 10⁻³."""

import math
from collections.abc import Callable

from runner.base.quantities import SUPERSCRIPT

_SMALLEST, _LARGEST = 1e-3, 1e4  # of what is written without a power of ten
Mark = Callable[[float], str]


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
