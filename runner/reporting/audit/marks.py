"""Marked differences between two formulas in Typst mathematics."""

import difflib
import re
from collections.abc import Sequence

_CALL = re.compile(r"(mat|vec|cases)\((.*)\)", re.DOTALL)
_SEPARATORS = (",", ";")
_OPEN, _CLOSE = "([{", ")]}"


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
