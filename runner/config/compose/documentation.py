"""Meanings and units of config keys, from the docstrings of their models."""

import inspect
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, get_args, runtime_checkable

from runner.schema.model import StrictModel

_ONE = r"(N m s/rad|N m/rad|N s/m|N/m|N m|N|kg m\^2|kg|m/s\^2|m/s|rad/s\^2|rad/s|rad|m|1/s|s|Hz)(?![\w/^])"
_UNIT = re.compile(rf"\b[Ii]n {_ONE}")
_TURNED = re.compile(rf" and {_ONE}")  # "in kg and kg m^2": of six axes, three along and three about them
_SLIDING = re.compile(rf"[;,] (?:or in )?{_ONE} where (?:it|a joint) slides")
_AXES_ALONG = 3


@dataclass(frozen=True)
class Units:
    """In which units a key counts; all are empty for a key without unit.

    Attributes:
        first: Its unit.
        turned: That of the last three of six axes, of a key that has a value for each.
        sliding: That of joints which slide, of a key that has values of joints.
    """

    first: str = ""
    turned: str = ""
    sliding: str = ""

    def at(self, place: Sequence[str | int]) -> tuple[str, ...]:
        """Return the units that a value may have, by its place in the config: keys, and numbers in lists."""
        if self.turned:
            axis = place[-1]
            return ((self.first, self.turned)[axis >= _AXES_ALONG],) if isinstance(axis, int) else ()
        return tuple(unit for unit in (self.first, self.sliding) if unit)


@runtime_checkable
class TellsUnits(Protocol):
    """A model whose keys count in units that follow from their names."""

    @classmethod
    def find_units(cls, path: Sequence[str]) -> Units | None:
        """Return the units of a key below it, given by the keys that lead to it; None where it has no such key."""
        ...


def meanings(model: type[StrictModel]) -> dict[str, str]:
    """Return what the docstrings of a model and its bases say of its keys."""
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        text = inspect.cleandoc(base.__doc__ or "").partition("Attributes:\n")[2]
        entries = re.findall(r"^    (\w+): (.+?)(?=^    \w|\Z)", text, re.M | re.S)
        found |= {name: " ".join(meaning.split()) for name, meaning in entries if name in model.model_fields}
    return found


def nested_model(annotation: Any) -> type[StrictModel] | None:
    """Return the model of a key that is a group of keys, null aside; None for any other."""
    for part in (annotation, *get_args(annotation)):
        if isinstance(part, type) and issubclass(part, StrictModel):
            return part
    return None


def find_units(model: type[StrictModel], path: Sequence[str]) -> Units | None:
    """Return the units of a key below a model; None where it has no such key.

    Args:
        model: The model of its group.
        path: The keys that lead to it, such as ["stages", "macro", "home"]; what stands behind it has no influence.
    """
    if issubclass(model, TellsUnits):
        return model.find_units(path)
    name, *rest = path[2:] if path[0] == "stages" and len(path) > 2 else path
    if name not in model.model_fields:
        return None
    inner = nested_model(model.model_fields[name].annotation)
    of_one = rest[1:] if rest and rest[0].isdecimal() else rest  # of a list of groups
    if inner is not None and of_one:
        return find_units(inner, of_one)
    text = meanings(model).get(name, "")
    found = _UNIT.search(text)
    if found is None:
        return Units()
    turned, sliding = _TURNED.match(text, found.end()), _SLIDING.match(text, found.end())
    return Units(found[1], turned[1] if turned else "", sliding[1] if sliding else "")
