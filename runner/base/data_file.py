"""Validated YAML data files, including untrusted ones."""

from pathlib import Path
from typing import Any, TypeVar

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
        RunnerError: if the file cannot be read or does not match the model; the message contains the file, the entries
            and the keys.
    """
    try:
        content = read_yaml(read_text(path, STORED.size), path.name)
    except (OSError, ValueError, YamlError) as error:
        raise RunnerError(f"cannot read {path}: {error}") from error
    try:
        return TypeAdapter(model).validate_python(content)
    except ValidationError as error:
        lines = [
            f"{_entry(content, problem['loc'])}{problem['msg'].removeprefix('Value error, ')}"
            for problem in error.errors()
        ]
        raise RunnerError(f"{path}: {'; '.join(lines)}") from error


def line_of(path: Path, text: str) -> int:
    """Return the number of the line of a data file that ends in a text."""
    before, _, _ = read_text(path, STORED.size).partition(f"{text}\n")
    return before.count("\n") + 1


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
