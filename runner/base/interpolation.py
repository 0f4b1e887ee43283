"""References between config values, such as ${robot.period}: syntax checks and size limits."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from runner.base.errors import ConfigError

_REFERENCE = re.compile(r"\$\{\s*(\.*[^\s.:${}'\"\\][^\s:${}'\"\\]*)\s*\}")
_SIZE = 2_000_000  # of a config whose references are replaced by what they stand for
_A_VALUE = 100  # in the same unit, beside its characters: what composing a value costs
_DEPTH = 60  # of collections and references within each other

Place = tuple[str | int, ...]


def calls_function(text: str) -> bool:
    """Tell whether a text holds a ${...} that is no reference to a key: oc.env would take secrets into a config."""
    return "${" in text and "${" in _REFERENCE.sub("", text)


def check_references(config: Mapping[str, Any]) -> None:
    """Check what the references of a composed config stand for, before any is resolved.

    Args:
        config: The config as plain data, references unresolved.

    Raises:
        ConfigError: for a key that refers to itself, or stands for too much.
    """
    _Sizes(config).of((), config)


class _Sizes:
    """Sizes of values with what they refer to, by their places; each is worked out once."""

    def __init__(self, config: Mapping[str, Any]) -> None:
        self._config = config
        self._known: dict[Place, int] = {}
        self._open: list[Place] = []

    def of(self, place: Place, value: Any) -> int:
        if place in self._known:
            return self._known[place]
        if place in self._open:
            raise ConfigError([f"{_dotted(place)}: refers to itself, by way of {_dotted(self._open[-1])}"])
        if len(self._open) > _DEPTH:
            raise ConfigError([f"{_dotted(self._open[-1])}: nested or referred to deeper than {_DEPTH} levels"])
        self._open.append(place)
        size = _A_VALUE + (len(value) if isinstance(value, str) else 0)
        for inner in self._within(place, value):
            size += self.of(*inner)
            if size > _SIZE:
                raise ConfigError([f"{_dotted(place) or 'the config'}: stands for too many values, by its references"])
        self._open.pop()
        self._known[place] = size
        return size

    def _within(self, place: Place, value: Any) -> Iterator[tuple[Place, Any]]:
        if isinstance(value, Mapping):
            yield from (((*place, key), item) for key, item in value.items())
        elif isinstance(value, list):
            yield from (((*place, number), item) for number, item in enumerate(value))
        elif isinstance(value, str):
            for reference in _REFERENCE.findall(value):
                target = _target(place, reference)
                try:
                    yield target, _at(self._config, target)
                except (KeyError, IndexError, TypeError):
                    continue  # OmegaConf says so where it is resolved


def _target(place: Place, reference: str) -> Place:
    """Return the place that a reference names; each leading dot is a collection, the first the one it stands in."""
    keys = reference.lstrip(".")
    dots = len(reference) - len(keys)
    path = [key for key in re.split(r"[.\[\]]", keys) if key]
    return (*(place[: len(place) - dots] if dots else ()), *path)


def _at(config: Any, place: Place) -> Any:
    for key in place:
        config = config[int(key)] if isinstance(config, Sequence) and not isinstance(config, str) else config[key]
    return config


def _dotted(place: Place) -> str:
    return ".".join(map(str, place))
