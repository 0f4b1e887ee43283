"""What chapters, reports and drawings say, line by line, as it is kept in tests/recorded.

A line is a field with its value: of an array its shape and some of its values, of a drawing its paths. Nothing is kept
that another processor changes: a number below 1e-8 is 0, and digits that rounding makes are #; see `lines`.
"""

import lzma
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from difflib import ndiff
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from runner.reporting.document import Provenance

_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_DIGITS = re.compile(r"(?<![\w#.-])(?:-?\d+(?:\.\d+)?(?:e[+-]?\d+|·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?|-?inf|nan|None)(?!\w|\.\d)")
_POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_SAME, _ZERO = 0.011, 1e-8  # so that a count is the same, and what rounding leaves
_HREF = "{http://www.w3.org/1999/xlink}href"
_HEAD = "=== "
_HASH = re.compile(r"\b(?:[0-9a-f]{24}|(?=\d*[a-f])[0-9a-f]{8})\b")
_OF_TODAY = ("date", "commit")
_PRINTED = re.compile(r"(less than )?(-?\d+(?:\.\d+)?)·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)")


def read(file: Path) -> dict[str, list[str]]:
    """Return the lines of a file by the names of what they describe."""
    parts = (part.split("\n") for part in lzma.decompress(file.read_bytes()).decode().split(_HEAD)[1:])
    return {name: rest[:-1] for name, *rest in parts}


def write(file: Path, kept: Mapping[str, Sequence[str]]) -> None:
    """Keep lines by names in a file."""
    text = "".join("".join(f"{line}\n" for line in (_HEAD + name, *kept[name])) for name in sorted(kept))
    file.write_bytes(lzma.compress(text.encode(), preset=9 | lzma.PRESET_EXTREME))


def changes(was: Sequence[str], now: Sequence[str]) -> list[str]:
    """Return how lines differ from what they were, as lines that begin with - or +."""
    if all(_agree(*each) for each in zip_longest(was, now, fillvalue="")):
        return []
    return [line for line in ndiff(was, now) if line[0] in "-+"]


def lines(what: Any, of_rounding: Sequence[str] = ()) -> list[str]:
    """Return the content of a section, a document or a drawing.

    Args:
        what: The section, document or drawing.
        of_rounding: Patterns of lines whose digits are made of rounding errors, such as those of a singular matrix or
            of a run that diverged. Their numbers are #, and those of all lines below; a caption or a title stands for
            everything that it describes.
    """
    found = [*_lines("is", what, 0)]
    for i, line in enumerate(found):
        if any(re.search(pattern, line) for pattern in of_rounding):
            for k in _described(found, i):
                found[k] = _DIGITS.sub("#", found[k])
    return found


def _described(found: Sequence[str], i: int) -> range:
    """Return the indices of the lines that a line stands for."""
    first = i
    if re.match(r" *(caption|title):", found[i]):
        first = next(k for k in range(i, -1, -1) if _depth(found[k]) < _depth(found[i]))
    last = next((k for k in range(first + 1, len(found)) if _depth(found[k]) <= _depth(found[first])), len(found))
    return range(first, last)


def _depth(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def _lines(name: str, value: Any, depth: int) -> Iterator[str]:
    head, below = f"{'  ' * depth}{name}:", depth + 1
    match value:
        case str() if value.lstrip().startswith("<"):
            yield from (f"{head} {path}" for path in _paths(value))
        case float() | np.floating():
            yield f"{head} {_digits(value)}"
        case np.ndarray():
            yield f"{head} {value.shape} {_some(value.ravel().astype(float))}"
        case Mapping():
            yield head
            for key, each in value.items():
                yield from _lines(str(key), each, below)
        case Sequence() if not isinstance(value, str):
            yield head
            for each in value:
                yield from _lines("-", each, below)
        case Provenance():  # versions, the machine and its clock
            return
        case _ if is_dataclass(value):
            yield f"{head} {type(value).__name__}"
            for field in (each for each in fields(value) if each.name not in _OF_TODAY):
                yield from _lines(field.name, getattr(value, field.name), below)
        case _:
            text = _PRINTED.sub(_printed, str(value)).replace("0 (rounding)", "0")
            yield _HASH.sub("...", f"{head} {text}".replace("\n", " "))


def _paths(svg: str) -> Iterator[str]:
    """Yield each text of a drawing, and style and places of each path that is no letter and of the marks."""
    yield from re.findall("<!-- (.*?) -->", svg)  # what matplotlib notes of the letters
    root = ET.fromstring(svg)
    letters = {path for definitions in root.findall(".//{*}defs") for path in definitions.iter()}
    for path in root.findall(".//{*}path"):
        if path not in letters:
            places = [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", path.get("d", ""))]
            yield f"{path.get('style', '')} {len(places)} {_some(np.round(places))}"
    marks: dict[str, list[float]] = {}
    for mark in root.findall(".//{*}use"):
        if mark.get(_HREF, "").startswith("#m"):  # no letter
            marks.setdefault(mark.get("style", ""), []).extend(float(mark.get(axis, "0")) for axis in "xy")
    for style, numbers in marks.items():
        yield f"marks {style} {len(numbers)} {_some(np.round(numbers))}"


def _some(values: np.ndarray[Any, Any]) -> str:
    some = values if values.size <= 8 else [*values[:: max(1, values.size // 8)], values.min(), values.max()]
    return " ".join(map(_digits, some))


def _digits(value: float) -> str:
    return "0" if abs(value) <= _ZERO else f"{value:.4g}"


def _printed(number: re.Match[str]) -> str:
    less, digits, power = number.groups()
    bound = digits == "1" and not less  # a condition's, such as 1·10⁻⁹
    return "0" if not bound and abs(float(f"{digits}e{power.translate(_POWERS)}")) <= _ZERO else number[0]


def _agree(was: str, now: str) -> bool:
    """Return whether two lines have the same words, and numbers that differ by no more than rounding."""
    if was == now:
        return True
    ours, theirs = (line.replace("·10", "e").translate(_POWERS) for line in (was, now))
    if _NUMBER.sub("", ours) != _NUMBER.sub("", theirs):
        return False
    return all(map(_is_same, _NUMBER.findall(ours), _NUMBER.findall(theirs)))


def _is_same(was: str, now: str) -> bool:
    """Return whether two numbers differ by no more than rounding."""
    digits, _, exponent = was.partition("e")
    last = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
    return abs(float(was) - float(now)) <= max(min(_SAME * abs(float(was)), 1.1 * last), _ZERO)
