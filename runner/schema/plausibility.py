"""Plausibility limits of numbers and strings in configs."""

import math
from collections.abc import Iterator
from typing import Any

from runner.base.sanitize import quoted

LARGEST = 1e12
"""Largest magnitude of a number, in SI units: the modulus of a stiff material."""
SMALLEST = 1e-12
"""Smallest magnitude of a nonzero number; numbers in lists may be smaller, such as coordinates after rounding."""
LARGEST_WHOLE = 10**18 - 1
"""Largest whole number, in magnitude."""
_TEXT = 4096


def absurd(key: str, value: Any) -> Iterator[str]:
    """Yield a problem for each implausible number or string in a config.

    Args:
        key: Dotted key of the value; "" for the root.
        value: The value as plain data.
    """
    return (f"{key}{problem}".lstrip(".") for problem in _beyond(value, in_list=False))


def _beyond(value: Any, in_list: bool) -> Iterator[str]:
    """Yield problems, each after its path below the value."""
    if isinstance(value, float):
        size = abs(value)
        if LARGEST < size < math.inf or (0.0 < size < SMALLEST and not in_list):  # models report inf and nan
            yield f": must lie between {SMALLEST:g} and {LARGEST:g} in magnitude; found {value:g}"
    elif isinstance(value, str):
        if len(value) > _TEXT:
            yield f": must have at most {_TEXT} characters; found {quoted(value)}"
    elif isinstance(value, int):
        if abs(value) > LARGEST_WHOLE:
            yield f": must be a whole number of at most 18 digits; found {quoted(value)}"
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from (f".{name}{problem}" for problem in _beyond(item, in_list=False))
    elif isinstance(value, list):
        for number, item in enumerate(value):
            yield from (f".{number}{problem}" for problem in _beyond(item, in_list=True))
