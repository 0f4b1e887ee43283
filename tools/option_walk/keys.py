"""Keys of configs with their values, and the keys of all kinds."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple, get_args, get_origin

from runner.config.groups import GROUPS
from runner.config.settings import RunSettings
from runner.plants import PLANTS
from runner.plugins.registry import Kinds
from runner.schema.model import StrictModel, nested_model
from tools.option_walk.scenes import WITHOUT_PHYSICS


class Key(NamedTuple):
    """A key of a config.

    Attributes:
        kind: Its group, with the kind if the group has kinds, such as "noise encoders"; "plant" for every plant,
            because each scene runs on each plant.
        name: Dotted key.
        value: Its value.
        allowed: Words that it allows.
    """

    kind: str
    name: str
    value: Any
    allowed: Sequence[Any]


def keys_of(resolved: Mapping[str, Any]) -> Iterator[Key]:
    """Yield each key of a config."""
    for group, content in resolved.items():
        if group in GROUPS:
            kind = content.get("kind")
            yield from _of_model(_kind_name(group, kind), group, content, _model(group, kind))
        else:
            field = RunSettings.model_fields.get(group)
            yield Key(group, group, content, _words(field.annotation) if field else ())


def known_keys() -> Iterator[tuple[str, str]]:
    """Yield the kind and the name of each key of all kinds of the walked groups."""
    for group, known in GROUPS.items():
        if group not in WITHOUT_PHYSICS:
            for kind in known.names() if isinstance(known, Kinds) else [None]:
                yield from ((_kind_name(group, kind), name) for name in _names(group, _model(group, kind)))


def _kind_name(group: str, kind: str | None) -> str:
    known = GROUPS[group]
    return f"{group} {kind or known.default}" if isinstance(known, Kinds) and known is not PLANTS else group


def _model(group: str, kind: str | None) -> type[StrictModel]:
    known = GROUPS[group]
    return known.config_model(kind or str(known.default)) if isinstance(known, Kinds) else known


def _of_model(kind: str, place: str, content: Mapping[str, Any], model: type[StrictModel]) -> Iterator[Key]:
    for name, value in content.items():
        field, key = model.model_fields.get(name), f"{place}.{name}"
        if field is None or name == "kind":
            continue
        inner = _inner(field.annotation)
        if inner is not None and isinstance(value, Mapping):
            yield from _of_model(kind, key, value, inner)
        else:
            yield Key(kind, key, value, _words(field.annotation))


def _names(place: str, model: type[StrictModel]) -> Iterator[str]:
    for name, field in model.model_fields.items():
        inner = _inner(field.annotation)
        if inner is not None:
            yield from _names(f"{place}.{name}", inner)
        elif name != "kind":
            yield f"{place}.{name}"


def _inner(annotation: Any) -> type[StrictModel] | None:
    """Return the model of a key that is a group of keys; None for a list or mapping of such groups."""
    parts = (annotation, *get_args(annotation))
    return None if any(get_origin(part) in (dict, list) for part in parts) else nested_model(annotation)


def _words(annotation: Any) -> list[Any]:
    """Return the words that an annotation allows."""
    if get_origin(annotation) is Literal:
        return list(get_args(annotation))
    return [word for part in get_args(annotation) for word in _words(part)]
