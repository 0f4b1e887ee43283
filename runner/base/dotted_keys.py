"""Values of a nested config by their dotted keys, and references between them, such as ${robot.period}."""

import contextlib
import re
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from runner.base.errors import ConfigError

Place = tuple[str | int, ...]
"""Keys and list indices that lead to a value, such as ("trajectory", "goal", 0)."""


def leaves(config: object, place: Place = (), lists: bool = True) -> Iterator[tuple[Place, Any]]:
    """Yield the path and value of each value; an empty group or list is also a value.

    Args:
        config: The config.
        place: Path of the config in a larger one.
        lists: True to yield the items of lists instead of lists.
    """
    inner = _items(config) if lists or not isinstance(config, list) else ()
    for key, item in inner:
        yield from leaves(item, (*place, key), lists)
    if place and not inner:
        yield place, config


def _items(config: object) -> Collection[tuple[Any, Any]]:
    """Return the keys and values of a group, or the indices and values of a list; nothing for any other value."""
    if isinstance(config, Mapping):
        return config.items()
    return list(enumerate(config)) if isinstance(config, list) else ()


def dotted(place: Place) -> str:
    """Return the dotted key of a path."""
    return ".".join(map(str, place))


def get(config: object, place: str | Place) -> Any:
    """Return the value at a path or dotted key of nested groups and lists; None if it does not exist."""
    for key in place.split(".") if isinstance(place, str) else place:
        if isinstance(config, list):
            with contextlib.suppress(ValueError, IndexError):
                config = config[int(key)]
                continue
        config = config.get(key) if isinstance(config, Mapping) else None
    return config


def put(config: Any, place: Place, value: object) -> None:
    """Put a value at a place of a config whose groups and lists exist."""
    for key in place[:-1]:
        config = config[key]
    config[place[-1]] = value


def split_override(text: str) -> tuple[str, str]:
    """Return the key and the value of an override KEY=VALUE, without Hydra's prefixes of the key."""
    key, _, value = text.lstrip("+~").partition("=")
    return key, value


_REFERENCE = re.compile(r"\$\{\s*(\.*[^\s.:${}'\"\\][^\s:${}'\"\\]*)\s*\}")
_SIZE = 2_000_000  # largest size of a config with expanded references
_A_VALUE = 100  # size of a value in addition to its characters, for the time to compose it
_DEPTH = 60  # largest depth of nested collections and references


def calls_function(text: str) -> bool:
    """Return True if a ${...} in a string is not a reference to a key; oc.env would copy secrets into a config."""
    return "${" in text and "${" in _REFERENCE.sub("", text)


def check_references(config: Mapping[str, Any]) -> None:
    """Check the references of a composed config before they are resolved.

    Args:
        config: The config as plain data with unresolved references.

    Raises:
        ConfigError: if a key refers to itself or expands to too many values.
    """
    _Sizes(config).of((), config)


def with_references(config: Mapping[str, Any]) -> "dict[str, Any] | None":
    """Return a copy of a composed config in which each reference such as ${robot.period} is the value of its key.

    OmegaConf takes ten times as long for the same.

    Args:
        config: The config as plain data with unresolved references.

    Returns:
        The copy; None if the config needs OmegaConf: for a reference in a longer string or relative to its place, and
        for one to a key that is missing or lies in a list or in the value of another reference.
    """
    try:
        return {key: _with_references(config, value, 0) for key, value in config.items()}
    except KeyError:
        return None


_ONE_REFERENCE = re.compile(r"\$\{(\w+(?:\.\w+)*)\}")
_MISSING = "???"  # in OmegaConf


def _with_references(config: Mapping[str, Any], value: Any, depth: int) -> Any:
    if depth > _DEPTH:
        raise KeyError(depth)
    if isinstance(value, dict):
        return {key: _with_references(config, item, depth + 1) for key, item in value.items()}
    if isinstance(value, list):
        return [_with_references(config, item, depth + 1) for item in value]
    if not (isinstance(value, str) and "${" in value):
        return value
    target: Any = config
    for key in match[1].split(".") if (match := _ONE_REFERENCE.fullmatch(value)) else ("",):
        target = target[key] if isinstance(target, dict) else _MISSING
    if target == _MISSING:
        raise KeyError(value)
    return _with_references(config, target, depth + 1)


class _Sizes:
    """Sizes of values by path, including the values to which they refer; each is computed once."""

    def __init__(self, config: Mapping[str, Any]) -> None:
        self._config = config
        self._known: dict[Place, int] = {}
        self._open: list[Place] = []

    def of(self, place: Place, value: Any) -> int:
        if place in self._known:
            return self._known[place]
        if place in self._open:
            raise ConfigError(f"{dotted(place)}: refers to itself, by way of {dotted(self._open[-1])}")
        if len(self._open) > _DEPTH:
            raise ConfigError(f"{dotted(self._open[-1])}: nested or referred to deeper than {_DEPTH} levels")
        self._open.append(place)
        size = _A_VALUE + (len(value) if isinstance(value, str) else 0)
        for inner in self._within(place, value):
            size += self.of(*inner)
            if size > _SIZE:
                raise ConfigError(f"{dotted(place) or 'the config'}: stands for too many values, by its references")
        self._open.pop()
        self._known[place] = size
        return size

    def _within(self, place: Place, value: Any) -> Iterator[tuple[Place, Any]]:
        if isinstance(value, str):
            targets = (_target(place, reference) for reference in _REFERENCE.findall(value))
            yield from ((target, found) for target in targets if (found := get(self._config, target)) is not None)
        else:
            yield from (((*place, key), item) for key, item in _items(value))


def _target(place: Place, reference: str) -> Place:
    """Return the path of a reference; one leading dot is the collection that contains it, each more its parent."""
    keys = reference.lstrip(".")
    dots = len(reference) - len(keys)
    path = [key for key in re.split(r"[.\[\]]", keys) if key]
    return (*(place[: len(place) - dots] if dots else ()), *path)
