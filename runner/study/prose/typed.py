"""Literal numbers in findings, which become outdated if the runs change."""

import re
from collections.abc import Iterable, Iterator, Set

from runner.base.expressions.insertions import insertions

_BOX = re.compile(r"^::: finding (.*?)^:::$", re.MULTILINE | re.DOTALL)
_MATHEMATICS = re.compile(r"\$[^$]*\$")
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?: [a-zA-Z%]+)?")
_PARTS = re.compile(r"[/,] ?")
# Names that hold a digit: parts of the source, of the arm, and of what the studies number.
_NAMED = re.compile(
    r"\b(?:[Ff]igures?|[Ss]ections?|[Tt]ables?|[Cc]laims?|[Cc]hapters?|[Ee]quations?|[Mm]ethods?|[Jj]oints?|[Ll]inks?|"
    r"[Ff]rames?|[Pp]oses?|Mini|xArm|Meca|rk|RK|q)"
    r"[ -]?\(?\d+(?:\.\d+)*(?:(?:, | and | or | to )\d+(?:\.\d+)*)*|^\d[a-c]?\. "
)


def typed_numbers(file: str, text: str, levels: Set[str]) -> Iterator[str]:
    """Yield each number that stands typed in a finding of a chapter, with file and line.

    Args:
        file: Name of the chapter's file.
        text: Its content.
        levels: Levels of axes, as the names of the study's runs have them; these may be typed.
    """
    for box in _BOX.finditer(text):
        words = "\n".join("" if line.startswith("holds:") else line for line in _blank(box[1]).splitlines())
        for number in sorted(typed_in(words, levels)):
            place = words.index(number)
            line = text.count("\n", 0, box.start()) + words.count("\n", 0, place) + 1
            yield f"{file}:{line}: {number}: a number typed in a finding goes stale; insert {{{{ metric(...) }}}}"


def levels_in(names: Iterable[str]) -> set[str]:
    """Return the levels of axes that the names of runs have."""
    return {part for name in names for part in _PARTS.split(name)}


def typed_in(words: str, levels: Set[str]) -> set[str]:
    """Return the numbers, with their units, that stand in some words and are neither a name nor a level."""
    return set(_NUMBER.findall(_NAMED.sub("", _MATHEMATICS.sub("", words)))) - levels


def _blank(box: str) -> str:
    """Return a box with each insertion in it left out, its lines kept."""
    for start, stop in reversed(list(insertions(box))):
        box = box[:start] + "…" + "\n" * box.count("\n", start, stop) + box[stop:]
    return box
