"""Marked differences between two formulas, or between two strings that cannot be parsed."""

import difflib
import re
from collections.abc import Iterator, Sequence

from runner.base.expressions.tree import ELLIPSIS

_CALL = re.compile(r"(mat|vec|cases)\((.*)\)", re.DOTALL)
_SEPARATORS = (",", ";")
_OPEN, _CLOSE = "([{", ")]}"
Pieces = list[tuple[bool, str]]
LONG = 130
"""Characters of a text that is shown whole."""
_AROUND = 24  # characters shown before and after each difference in a longer one


def marked_formulas(first: str, second: str) -> tuple[str, str]:
    """Return both formulas with what the other lacks in `differs(...)`; as they are where they share nothing."""
    ours, theirs = _atoms(first, " "), _atoms(second, " ")
    left: list[str] = []
    right: list[str] = []
    matcher = difflib.SequenceMatcher(None, ours, theirs, autojunk=False)
    operations = matcher.get_opcodes()
    if not any(kind == "equal" for kind, *_ in operations) and len(ours) + len(theirs) > 2:
        return first, second
    for kind, start, end, other_start, other_end in operations:
        one, other = ours[start:end], theirs[other_start:other_end]
        if kind == "equal":
            left += one
            right += other
            continue
        inside = _inside(one[0], other[0]) if len(one) == len(other) == 1 else None
        left += [inside[0]] if inside else _marked(one)
        right += [inside[1]] if inside else _marked(other)
    return " ".join(left), " ".join(right)


def _inside(one: str, other: str) -> tuple[str, str] | None:
    """Return two matrices of as many elements with the differing elements marked; None where they are none."""
    ours, theirs = _CALL.fullmatch(one), _CALL.fullmatch(other)
    if ours is None or theirs is None or ours[1] != theirs[1]:
        return None
    left, right = (_atoms(each[2], "") for each in (ours, theirs))
    if [each for each in left if each in _SEPARATORS] != [each for each in right if each in _SEPARATORS]:
        return None
    pairs = [marked_formulas(a, b) if a != b else (a, b) for a, b in zip(left, right, strict=True)]
    inner = ("".join(pair[side] for pair in pairs) for side in (0, 1))
    first, second = (f"{ours[1]}({text})" for text in inner)
    return first, second


def _marked(atoms: Sequence[str]) -> list[str]:
    """Return atoms with a mark around each run of them between commas."""
    found: list[str] = []
    run: list[str] = []
    for atom in [*atoms, ","]:
        if atom not in (*_SEPARATORS, "quad", "="):
            run.append(atom)
            continue
        if run:
            found.append(f"differs({' '.join(run)})")
        run = []
        found.append(atom)
    return found[:-1]


def _atoms(text: str, ends: str) -> list[str]:
    """Return what stands between separators, and between the ends given, outside of brackets and quotes."""
    found, depth, quoted, atom = [], 0, False, ""
    for letter in text:
        quoted ^= letter == '"'
        depth += 0 if quoted else (letter in _OPEN) - (letter in _CLOSE)
        if quoted or depth or not (letter in _SEPARATORS or letter in ends):
            atom += letter
            continue
        found += [each for each in (atom, letter) if each.strip()]
        atom = ""
    return [each.strip() for each in (*found, atom) if each.strip()]


def pieces(text: str, beside: str) -> Pieces:
    """Return a text in pieces, each with whether the other text lacks it; dots stand for long stretches in common."""
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
    """Return the beginning of a text."""
    return [(False, text if len(text) <= LONG else f"{text[:LONG]} {ELLIPSIS}")]


def _around(found: Pieces) -> Iterator[tuple[bool, str]]:
    for place, (marked, piece) in enumerate(found):
        before, behind = place > 0, place + 1 < len(found)
        if marked or len(piece) <= _AROUND * (before + behind) + 3:
            yield marked, piece
            continue
        yield False, (piece[:_AROUND] if before else "") + f" {ELLIPSIS} " + (piece[-_AROUND:] if behind else "")
