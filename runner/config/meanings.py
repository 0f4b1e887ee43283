"""What config keys mean and in which unit they count, as the docstrings of their models say."""

import contextlib
import inspect
import re
from collections.abc import Iterator, Sequence
from typing import Any, get_args

from runner.config.groups import GROUPS
from runner.config.robot import OneArmConfig, StageConfig
from runner.config.settings import RunSettings
from runner.errors import ConfigError
from runner.registry import Kinds, StrictModel

_UNIT = re.compile(
    r"\b[Ii]n (N m s/rad|N m/rad|N s/m|N/m|N m|N|kg m\^2|kg|m/s\^2|m/s|rad/s\^2|rad/s|rad|m|1/s|s|Hz)(?![\w/^])"
)


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


def key_unit(key: str) -> str:
    """Return the unit of a dotted key, such as "rad/s" of "controller.natural_frequency".

    It is "1" for a key without unit, of which nothing is known, or that counts otherwise in each kind of its group.
    """
    group, *rest = key.split(".")
    units = {_unit(model, rest or [group]) for model in _models(group if rest else "", rest)} - {None}
    return units.pop() or "1" if len(units) == 1 else "1"


def _models(group: str, rest: Sequence[str]) -> Iterator[type[StrictModel]]:
    known = GROUPS.get(group)
    if not group:
        yield RunSettings
    elif rest[0] == "stages":
        yield from (StageConfig, OneArmConfig)
    elif isinstance(known, Kinds):
        for kind in known.names():
            with contextlib.suppress(ConfigError):  # a part of the user's that cannot be imported
                yield known.config_model(kind)
    elif known is not None:
        yield known


def _unit(model: type[StrictModel], path: Sequence[str]) -> str | None:
    """Return the unit of a key below a model; None where it has no such key."""
    name, *rest = path[2:] if path[0] == "stages" and len(path) > 2 else path
    if name not in model.model_fields:
        return None
    inner = nested_model(model.model_fields[name].annotation)
    if inner is not None and rest:
        return _unit(inner, rest)
    found = _UNIT.search(meanings(model).get(name, ""))
    return found[1] if found else ""
