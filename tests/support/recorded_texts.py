"""Chapters, reports and drawings as readable text, as recorded in tests/recorded.

A line is a field with its value, a row of a table, or one sentence of a longer string. Of an array it has the shape and
some of the values, of a drawing the paths. Fields with their default values, and empty ones, are left out. No line
depends on the processor: a number below 1e-8 is 0, and digits that rounding makes are #; see `lines` and `settle`.
"""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass
from difflib import SequenceMatcher, unified_diff
from pathlib import Path
from typing import Any

import numpy as np

from runner.reporting.document import Provenance

_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_DIGITS = re.compile(r"(?<![\w#.-])(?:-?\d+(?:\.\d+)?(?:e[+-]?\d+|·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?|-?inf|nan|None)(?!\w|\.\d)")
_POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_SAME, _ZERO = 0.011, 1e-8  # so that a count is the same, and what rounding leaves
_LONG = 120  # characters of a line; a longer string has a line for each sentence
_SENTENCE = re.compile(r"(?<=[.;?!]) +(?=\S)")
_MOST_SHOWN = 80  # lines of a difference
_HREF = "{http://www.w3.org/1999/xlink}href"
_HASH = re.compile(r"(?<!\w)(?<!\d\.)(?:[0-9a-f]{24}|[0-9a-f]{8})(?!\w|\.\d)")
_OF_TODAY = ("date", "commit")
_PRINTED = re.compile(r"(less than )?(-?\d+(?:\.\d+)?)·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)")


def read(file: Path) -> list[str]:
    """Return the recorded lines of a file; none if it does not exist."""
    return file.read_text(encoding="utf-8").splitlines() if file.is_file() else []


def write(file: Path, content: Sequence[str]) -> None:
    """Record lines in a file."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("".join(f"{line}\n" for line in content), encoding="utf-8")


def settle(was: Sequence[str], now: Sequence[str]) -> list[str]:
    """Return new lines, with the recorded line wherever the two differ by no more than rounding."""
    if was == now:
        return list(now)
    settled = list(now)
    ours, theirs = ([_NUMBER.sub("", _plain(line)) for line in each] for each in (was, now))
    for first, place, count in SequenceMatcher(None, ours, theirs).get_matching_blocks():
        for k in range(count):
            if _agree(was[first + k], now[place + k]):
                settled[place + k] = was[first + k]
    return settled


def changes(name: str, was: Sequence[str], now: Sequence[str]) -> str:
    """Return the differences of lines from the recorded ones, with line numbers; an empty string if they agree."""
    told = [*unified_diff(was, now, f"{name} as recorded", f"{name} now", n=1, lineterm="")]
    rest = len(told) - _MOST_SHOWN
    shown = [*told[:_MOST_SHOWN], f"... and {rest} more lines"] if rest > 0 else told
    return "\n".join([f"{name} differs; if meant: make record", *shown] if told else [])


def lines(what: Any, of_rounding: Sequence[str] = ()) -> list[str]:
    """Return the content of a section, a document or a drawing.

    Args:
        what: The section, document or drawing.
        of_rounding: Patterns of lines whose digits are made of rounding errors, such as those of a singular matrix or
            of a run that diverged. Their numbers are #, and those of all lines below; a caption or a title stands for
            everything that it describes.
    """
    found = [*_lines("", what, 0)]
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
    """Yield the lines of a value with a name, such as "title:"; "-" is an entry of a list, and "" the whole."""
    head = f"{'  ' * depth}{name} " if name else ""
    below = depth + bool(name)
    indent = "  " * below
    if isinstance(value, Provenance):  # versions, the machine and its clock
        return
    if isinstance(value, str) and value.lstrip().startswith("<"):
        yield from ([head.rstrip()] if name else [])
        yield from (indent + path for path in _paths(value))
    elif is_dataclass(value):
        yield f"{head}{type(value).__name__}"
        for each in fields(value):
            own = getattr(value, each.name)
            if each.repr and each.name not in _OF_TODAY and not _is_default(each, own):
                yield from _lines(f"{each.name}:", own, depth + 1)
    elif isinstance(value, Mapping):
        yield from ([head.rstrip()] if name else [])
        for key, own in value.items():
            yield from _lines(f"{key}:", own, below)
    elif isinstance(value, Sequence) and not isinstance(value, str):
        row = _row(value)
        if row is not None and len(head) + len(row) <= _LONG:
            yield (head + row).rstrip()
        else:
            yield from ([head.rstrip()] if name else [])
            for own in value:
                yield from _lines("-", own, below)
    else:
        text = _text(value)
        first, *rest = _SENTENCE.split(text) if len(text) > _LONG else [text]
        yield (head + first).rstrip()
        yield from (f"{indent}{sentence}" for sentence in rest)


def _is_default(field: Field[Any], value: Any) -> bool:
    """Return True if a field has its default value, or an empty one."""
    if isinstance(value, np.ndarray):
        return value.size == 0
    if value is None or (isinstance(value, str | Sequence | Mapping) and not value):
        return True
    default = field.default if field.default_factory is MISSING else field.default_factory()
    return not isinstance(default, np.ndarray) and bool(default == value)


def _row(values: Sequence[Any]) -> str | None:
    """Return values in one line; None if some of them are not numbers or strings."""
    drawn = any(isinstance(each, str) and each.lstrip().startswith("<") for each in values)
    plain = all(each is None or isinstance(each, str | int | float | np.number) for each in values)
    return " | ".join(map(_text, values)) if plain and not drawn else None


def _text(value: Any) -> str:
    """Return a value as text without names of runs and without digits that rounding makes."""
    if isinstance(value, float | np.floating):
        return _digits(value)
    if isinstance(value, np.ndarray):
        return f"{value.shape} {_some(value.ravel().astype(float))}"
    text = _PRINTED.sub(_printed, str(value)).replace("0 (rounding)", "0")
    return _HASH.sub("...", " ".join(text.split()))


def _paths(svg: str) -> Iterator[str]:
    """Yield each text of a drawing, and style and places of each path that draws no letter and of the marks."""
    yield from re.findall("<!-- (.*?) -->", svg)  # what matplotlib notes of the letters
    root = ET.fromstring(svg)
    letters = {path for definitions in root.findall(".//{*}defs") for path in definitions.iter()}
    for path in root.findall(".//{*}path"):
        if path not in letters:
            places = [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", path.get("d", ""))]
            yield f"{path.get('style', '')} {len(places)} {_some(np.round(places))}".lstrip()
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


def _plain(line: str) -> str:
    """Return a line with its powers of ten as exponents."""
    return line.replace("·10", "e").translate(_POWERS)


def _agree(was: str, now: str) -> bool:
    """Return True if two lines have the same words, and numbers that differ by no more than rounding."""
    if was == now:
        return True
    ours, theirs = _plain(was), _plain(now)
    if _NUMBER.sub("", ours) != _NUMBER.sub("", theirs):
        return False
    return all(map(_is_same, _NUMBER.findall(ours), _NUMBER.findall(theirs)))


def _is_same(was: str, now: str) -> bool:
    """Return True if two numbers differ by no more than rounding."""
    digits, _, exponent = was.partition("e")
    last = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
    return abs(float(was) - float(now)) <= max(min(_SAME * abs(float(was)), 1.1 * last), _ZERO)
