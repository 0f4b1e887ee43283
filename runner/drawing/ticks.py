"""Labels of the marks on an axis, written as the text writes numbers: 0.05 and 100, 5·10⁻⁴, 10⁻³."""

import math

from runner.quantities import number

_PLAIN = 1e-3  # what is smaller has a power of ten


def mark(value: float, position: int | None = None) -> str:
    """Return the label of a mark, with as many digits as it needs; matplotlib hands its position over, too."""
    value = float(f"{value:.6g}")  # a locator's 0.3 is off by rounding
    digits = next(count for count in range(1, 7) if math.isclose(float(f"{value:.{count - 1}e}"), value, rel_tol=1e-6))
    text = number(value, digits, plain=_PLAIN)
    return text.replace("-1·10", "-10").removeprefix("1·")


def minor_mark(value: float, position: int | None = None) -> str:
    """Return the label of a mark between two powers of ten: at 2 and 5 alone."""
    return mark(value) if f"{value:.0e}"[0] in "25" else ""
