"""Validated YAML data files, including untrusted ones."""

import re
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import TypeAdapter, ValidationError

from runner.base.bounded_yaml import STORED, YamlError, read_yaml
from runner.base.errors import RunnerError
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
            f"{_entry(content, each['loc'])}{each['msg'].removeprefix('Value error, ')}{_line(text, each['loc'])}"
            for each in error.errors()
        ]
        raise RunnerError(f"{path}: {'; '.join(lines)}") from error


def line_of(path: Path, text: str) -> int:
    """Return the number of the line of a data file that has a text, not followed by more of a name."""
    before = re.split(rf"{re.escape(text)}(?![\w.-])", read_text(path, STORED.size), maxsplit=1)[0]
    return before.count("\n") + 1


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
