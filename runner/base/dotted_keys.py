"""Values of a nested config by their dotted keys."""

from collections.abc import Iterator, Mapping
from typing import Any

Place = tuple[str | int, ...]
"""Keys and list indices that lead to a value, such as ("trajectory", "goal", 0)."""


def leaves(config: object, place: Place = (), lists: bool = True) -> Iterator[tuple[Place, Any]]:
    """Yield the place and value of each value; an empty group or list is also a value.

    Args:
        config: The config.
        place: The place of the config in a larger one.
        lists: Whether to yield the items of lists instead of lists.
    """
    inner: Mapping[Any, object] = {}
    if isinstance(config, Mapping):
        inner = config
    elif lists and isinstance(config, list):
        inner = dict(enumerate(config))
    for key, item in inner.items():
        yield from leaves(item, (*place, key), lists)
    if place and not inner:
        yield place, config


def dotted(place: Place) -> str:
    """Return the dotted key of a place."""
    return ".".join(map(str, place))


def get(config: object, place: str | Place) -> Any:
    """Return the value at a place or dotted key of nested groups; None if there is none."""
    for key in place.split(".") if isinstance(place, str) else place:
        config = config.get(key) if isinstance(config, Mapping) else None
    return config


def put(config: Any, place: Place, value: object) -> None:
    """Put a value at a place of a config whose groups and lists exist."""
    for key in place[:-1]:
        config = config[key]
    config[place[-1]] = value
