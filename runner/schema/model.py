"""Base class of every config model, and plausibility limits of numbers and strings in configs."""

import math
from collections.abc import Iterator, Sequence
from typing import get_args

from pydantic import BaseModel, ConfigDict
from pydantic.fields import FieldInfo

from runner.base.sanitize import quoted
from runner.schema.units import Unit


class StrictModel(BaseModel):
    """Base of every config model: no unknown key, no silent conversion, no NaN or infinity, immutable."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)

    @classmethod
    def find_field(cls, path: Sequence[str]) -> FieldInfo | None:
        """Return the field of a key below this model; None if there is no such key.

        Args:
            path: Keys that lead to the key, such as ["stages", "macro", "home"]; the method ignores keys and indices
                after it.
        """
        name, *rest = path[2:] if path[0] == "stages" and len(path) > 2 else path
        if name not in cls.model_fields:
            return None
        field = cls.model_fields[name]
        inner, of_one = nested_model(field.annotation), rest[1:] if rest and rest[0].isdecimal() else rest
        return inner.find_field(of_one) if inner is not None and of_one else field

    @classmethod
    def find_unit(cls, path: Sequence[str]) -> Unit | None:
        """Return the unit of a key below this model; None for an unknown key. See find_field."""
        field = cls.find_field(path)
        return None if field is None else next((each for each in field.metadata if isinstance(each, Unit)), Unit())


def nested_model(annotation: object) -> type[StrictModel] | None:
    """Return the model of a key that is a group of keys or a list of such groups; None for any other key."""
    for part in (annotation, *get_args(annotation)):
        if isinstance(part, type) and issubclass(part, StrictModel):
            return part
    return None


LARGEST = 1e12
"""Largest magnitude of a number, in SI units: the modulus of a stiff material."""
SMALLEST = 1e-12
"""Smallest magnitude of a nonzero number; numbers in lists may be smaller, such as coordinates after rounding."""
LARGEST_WHOLE = 10**18 - 1
"""Largest whole number, in magnitude."""
_TEXT = 4096


def absurd(key: str, value: object) -> Iterator[str]:
    """Yield a problem for each implausible number or string in a config.

    Args:
        key: Dotted key of the value; "" for the root.
        value: The value as plain data.
    """
    return (f"{key}{problem}".lstrip(".") for problem in _beyond(value, in_list=False))


def _beyond(value: object, in_list: bool) -> Iterator[str]:
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
