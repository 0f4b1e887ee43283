"""Validated YAML data files, including untrusted ones."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar, get_args

import yaml
from pydantic import BaseModel, TypeAdapter, ValidationError

from runner.base.bounded_yaml import STORED, YamlError, read_yaml
from runner.base.errors import RunnerError, nearest
from runner.base.limits import read_text

T = TypeVar("T")


def read_data(path: Path, model: type[T]) -> T:
    """Return the content of a data file.

    Args:
        path: The file.
        model: A pydantic model, or a list of models.

    Raises:
        RunnerError: if the file cannot be read or does not match the model; the message contains the file, the
            entries, the keys and the lines.
    """
    try:
        text = read_text(path, STORED.size)
        content = read_yaml(text, path.name)
    except (OSError, ValueError, YamlError) as error:
        raise RunnerError(f"cannot read {path}: {error}") from error
    try:
        return TypeAdapter(model).validate_python(content)
    except ValidationError as error:
        lines = [
            f"{_entry(content, each['loc'])}{_explain(model, dict(each))}{_line(text, each['loc'])}"
            for each in error.errors()
        ]
        raise RunnerError(f"{path}: {'; '.join(lines)}") from error


def line_of(path: Path, text: str) -> int:
    """Return the number of the line of a data file that has a text, not followed by more of a name."""
    before = re.split(rf"{re.escape(text)}(?![\w.-])", read_text(path, STORED.size), maxsplit=1)[0]
    return before.count("\n") + 1


def _explain(model: Any, problem: dict[str, Any]) -> str:
    """Return the message of a problem; one of an unknown key names the keys that are allowed in its place."""
    if problem["loc"] and problem["input"] is None:
        return "needs a value; found null"
    if problem["type"] != "extra_forbidden":
        return str(problem["msg"]).removeprefix("Value error, ")
    *groups, key = problem["loc"]
    inside = list(_models(model))
    for group in groups:
        kinds = [each.model_fields[group].annotation for each in inside if group in each.model_fields]
        inside = [nested for kind in kinds for nested in _models(kind)] or inside
    keys = list(dict.fromkeys(field.alias or name for each in inside for name, field in each.model_fields.items()))
    return f"unknown key{nearest(str(key), keys)}; keys: {', '.join(keys)}"


def _models(kind: Any) -> Iterator[type[BaseModel]]:
    """Yield the models in an annotation."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield kind
    for inner in get_args(kind):
        yield from _models(inner)


def _line(text: str, location: tuple[int | str, ...]) -> str:
    """Return the line of a location in a file, in brackets."""
    node, line = yaml.compose(text, Loader=yaml.CSafeLoader), 0
    for key in location:
        match node:
            case yaml.MappingNode():
                found = {name.value: (name.start_mark.line, value) for name, value in node.value}
            case yaml.SequenceNode():
                found = {str(place): (item.start_mark.line, item) for place, item in enumerate(node.value)}
            case _:
                break
        line, node = found.get(str(key), (line, None))
    return f" (line {line + 1})"


def _entry(content: Any, location: tuple[int | str, ...]) -> str:
    """Return the location of a problem in a file, with the name or number of list entries."""
    words, inside = [], content
    for key in location:
        word = str(key)
        if isinstance(key, int) and isinstance(inside, list):
            inside = inside[key]
            own = inside.get("name", inside.get("number")) if isinstance(inside, dict) else None
            word += "" if own is None else f" ({own})"
        else:
            inside = inside.get(key) if isinstance(inside, dict) else None
        words.append(word)
    return f"{'.'.join(words)}: " if words else ""
