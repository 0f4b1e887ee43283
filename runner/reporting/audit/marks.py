"""Marked differences between two strings that cannot be parsed."""

import difflib
from collections.abc import Iterator

from runner.base.expressions.tree import ELLIPSIS

Pieces = list[tuple[bool, str]]
LONG = 130
"""Characters of a string that is shown whole."""
_AROUND = 24  # characters shown before and after each difference in a longer one


def pieces(text: str, beside: str) -> Pieces:
    """Return a string in pieces, each with True if the other string lacks it; dots replace long common stretches."""
    found: Pieces = []
    matcher = difflib.SequenceMatcher(None, text, beside, autojunk=False)
    for kind, start, end, other_start, other_end in matcher.get_opcodes():
        if kind == "equal":
            found.append((False, text[start:end]))
        elif end > start:
            found.append((True, text[start:end]))
        elif other_end > other_start:
            found.append((True, "\u200a"))  # what the other has more leaves a mark of no width
    return found if len(text) <= LONG else list(_around(found))


def cut(text: str) -> Pieces:
    """Return the beginning of a string."""
    return [(False, text if len(text) <= LONG else f"{text[:LONG]} {ELLIPSIS}")]


def _around(found: Pieces) -> Iterator[tuple[bool, str]]:
    for place, (marked, piece) in enumerate(found):
        before, behind = place > 0, place + 1 < len(found)
        if marked or len(piece) <= _AROUND * (before + behind) + 3:
            yield marked, piece
            continue
        yield False, (piece[:_AROUND] if before else "") + f" {ELLIPSIS} " + (piece[-_AROUND:] if behind else "")
