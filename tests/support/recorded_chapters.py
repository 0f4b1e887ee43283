"""What the chapters of the studies say of the recorded runs, kept in tests/recorded line by line.

`PYTHONPATH=tests .venv/bin/python -m support.recorded_chapters [STUDY...]` prints what has changed and records it
again. A line is a field with its value; an array has its size and a few of its values, a picture its elements.
"""

import lzma
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from difflib import ndiff
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
from fixtures.studies import make_study
from support.recorded_runs import FOLDER
from support.study_plans import STUDIES, chapters_made

from runner.reporting.document import Section

_TAG = re.compile(r"<(\w+)")
_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_SAME, _ZERO = 0.011, 1e-8  # one in the last of three digits, and what rounding leaves
_HEAD = "=== "


def changes(study: str, file: str, section: Section) -> list[str]:
    """Return how a chapter differs from what is recorded, as lines that begin with - or +."""
    was, now = _read(study).get(file, []), lines(section)
    if all(_agree(*each) for each in zip_longest(was, now, fillvalue="")):
        return []
    return [line for line in ndiff(was, now) if line[0] in "-+"]


def lines(section: Section) -> list[str]:
    """Return the content of a section."""
    return [*_lines("section", section, 0)]


def record(study: str, chapters: Mapping[str, Section]) -> None:
    """Keep the content of the chapters of a study, by their files."""
    text = "".join("".join(f"{line}\n" for line in (_HEAD + file, *lines(chapters[file]))) for file in chapters)
    _place(study).write_bytes(lzma.compress(text.encode(), preset=9 | lzma.PRESET_EXTREME))


@cache
def _read(study: str) -> dict[str, list[str]]:
    if not _place(study).is_file():
        return {}
    text = lzma.decompress(_place(study).read_bytes()).decode()
    chapters = (chapter.split("\n") for chapter in text.split(_HEAD)[1:])
    return {file: rest[:-1] for file, *rest in chapters}


def _place(study: str) -> Path:
    return FOLDER / f"{study}.chapters.xz"


def _lines(name: str, value: Any, depth: int) -> Iterator[str]:
    head = f"{'  ' * depth}{name}:"
    match value:
        case str() if value.lstrip().startswith("<"):
            yield f"{head} picture of {len(_TAG.findall(value))} elements"
        case float() | np.floating():
            yield f"{head} {value:.4g}"
        case np.ndarray():
            yield f"{head} {_array(value)}"
        case Mapping():
            yield head
            for key, each in value.items():
                yield from _lines(str(key), each, depth + 1)
        case Sequence() if not isinstance(value, str):
            yield head
            for each in value:
                yield from _lines("-", each, depth + 1)
        case _ if is_dataclass(value):
            yield f"{head} {type(value).__name__}"
            for field in fields(value):
                yield from _lines(field.name, getattr(value, field.name), depth + 1)
        case _:
            yield f"{head} {value}".replace("\n", " ")


def _array(values: np.ndarray[Any, Any]) -> str:
    flat = values.ravel().astype(float)
    some = flat if flat.size <= 8 else [*flat[:: max(1, flat.size // 8)], flat.min(), flat.max()]
    return f"{values.shape} {' '.join(f'{each:.4g}' for each in some)}"


def _agree(was: str, now: str) -> bool:
    """Return whether two lines have the same words, and numbers that differ by no more than rounding."""
    if was == now:
        return True
    ours, theirs = (line.replace("·10", "e").translate(_POWERS) for line in (was, now))
    if _NUMBER.sub("", ours) != _NUMBER.sub("", theirs):
        return False
    numbers = ([float(number) for number in _NUMBER.findall(line)] for line in (ours, theirs))
    return bool(np.allclose(*numbers, rtol=_SAME, atol=_ZERO))


if __name__ == "__main__":
    for name in sys.argv[1:] or STUDIES:
        with tempfile.TemporaryDirectory() as folder:
            made = make_study(name, Path(folder))
            sections = {file: made.chapters.section(file) for file in chapters_made(name)}
        changed = [line for file in sections for line in changes(name, file, sections[file])]
        print(f"{name}: {len(changed)} lines changed", *changed[:200], sep="\n")
        record(name, sections)
