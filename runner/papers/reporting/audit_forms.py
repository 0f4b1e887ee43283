"""Displayed forms of an audited equation, shortened, with differences marked and the elements it resembles."""

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import replace
from itertools import accumulate
from types import MappingProxyType

from runner.papers.audit.entry import Entry, Form, left_side
from runner.papers.audit.verdict import CheckedEquation
from runner.papers.expressions.difference import ExpressionDifference, difference
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.parser import parse
from runner.papers.expressions.tree import ELLIPSIS, Call, Name, Node, Sum, holds, parts, shorten_expression, size
from runner.papers.expressions.typesetting import Letters, linear, typeset
from runner.papers.reporting.equation import EquationForm

Pieces = list[tuple[bool, str]]
LONG = 130
"""Characters of a string that is shown whole."""
_AROUND = 24  # characters shown before and after each difference in a longer one
_SYMBOLS = 40  # symbols of a form that is shown whole
_OTHER = 0.5  # share of symbols that differ from which on an expression is another, and not one with a fault
_LONGEST = 5000  # characters of a string that is compared sign by sign
_FAULTS = 6  # differing parts up to which it is one with faults

_Elements = Mapping[str, Node]
_Shown = list[tuple[Node, Node]]
_ELEMENT = re.compile(r"(?P<name>\w+?)_(?P<place>\d\d|[xyz])")
_PLACED = re.compile(r"\w+_\d\d")
_VECTOR = ("x", "y", "z")


class RightElements:
    """The right forms of the elements of a source's matrices, by name.

    Args:
        checked: The equations of the source.
    """

    def __init__(self, checked: Iterable[CheckedEquation]) -> None:
        self._right: dict[str, Node] = {}
        for each in checked:
            entry = each.entry
            if each.verdict not in ("unreadable", "definition"):
                texts = {name: text for name, text in entry.true_form.elements.items() if _PLACED.fullmatch(name)}
                self._right |= {name: parse(text).root for name, text in texts.items()}

    def misplaced(self, entry: Entry, elements: Mapping[str, Node]) -> str:
        """Return the other element that a wrong one is, except for exchanged symbols, in a sentence; empty without one.

        Args:
            entry: An equation that is wrong.
            elements: What it says; one element can be another.
        """
        if len(elements) != 1:
            return ""
        ((name, node),) = elements.items()
        if size(node) < 2 or name not in self._right or difference(node, self._right[name]).symbols_alone:
            return ""
        found = [(other, difference(node, right)) for other, right in self._right.items() if size(right) == size(node)]
        alike = [(other, each) for other, each in found if each.symbols_alone and other != name]
        if not alike:
            return ""
        family = name.rpartition("_")[0]
        other, best = min(alike, key=lambda each: (each[1].exchanged.total(), each[0].rpartition("_")[0] != family))
        return f"It is the right ${_typeset_name(other)}${_exchanged(best)}."


def forms_of(entry: Entry, right: RightElements, letters: Letters = MappingProxyType({})) -> list[EquationForm]:
    """Return the forms of an equation, each with what it does not share with the next one marked.

    Args:
        entry: The equation.
        right: The right forms of the equations around it.
        letters: Names as the source writes them.
    """
    named = {"as printed": entry.printed, "emended": entry.emendation, "corrected": entry.corrected}
    shown: dict[str, Form] = {label: form for label, form in named.items() if form is not None}
    forms = [*shown.values()]
    read = [_read(form) for form in forms]
    marks = _marks(read)
    found = []
    for place, (label, form, elements) in enumerate(zip(shown, forms, read, strict=True)):
        note = entry.emendation.why if entry.emendation is not None and form is entry.emendation else ""
        beside = forms[1 - place] if len(forms) > 1 and place < 2 else None
        if form.math:
            is_same = form is entry.emendation and form.math == entry.printed.math
            found.append(EquationForm(label, () if is_same else [[form.math]], note=note))
        elif elements is None:
            found.append(_unread(f"{label}, as the text has it", form, beside, note))
        elif form is entry.emendation and read[0] is None and not (entry.printed.math or entry.corrected):
            found.append(_unread(label, form, beside, note))
        else:
            like = right.misplaced(entry, elements) if len(forms) == place + 2 and entry.corrected is not None else ""
            told = f"{note} {like}".strip()
            made = _shown(label, form, elements, marks[place], told, letters, like=like, alone=len(forms) == 1)
            if made.lines and entry.indices:
                numbers = [f"{each} = {', '.join(map(str, found))}" for each, found in entry.indices.items()]
                made = replace(made, lines=[*made.lines[:-1], [*made.lines[-1], *numbers]])
            emended = entry.emendation is not None and beside is not None and form is not entry.corrected
            empty = not (made.lines or like) and len(_text(form)) < _LONGEST
            found.append(_unread(label, form, beside, note) if emended and empty else made)
    return found


def _read(form: Form) -> _Elements | None:
    """Return the elements of a form, whose parts know their places in all of it; None where one cannot be read."""
    found, place = {}, 0
    try:
        for name, text in form.elements.items():
            found[name] = parse(" " * place + text).root
            place += len(text)
    except ExpressionError:
        return None
    return found


def _marks(read: list[_Elements | None]) -> list[set[Node]]:
    """Return the parts of each form that the next one lacks; of the last form, those that the previous one lacks."""
    marks: list[set[Node]] = [set() for _ in read]
    for place in range(len(read) - 1):
        ours, theirs = read[place] or {}, read[place + 1] or {}
        if len(ours) == len(theirs):
            marks[place], marks[place + 1] = map(set, _differing(ours, theirs))
    return marks


def _differing(ours: _Elements, theirs: _Elements) -> tuple[set[Node], set[Node]]:
    """Return the parts of two forms in which they differ, names on the left included."""
    first, second = set[Node](), set[Node]()
    for one, other in zip(ours, theirs, strict=True):
        if one != other:
            first.add(left_side(one))
            second.add(left_side(other))
    left, right = list(_cells(ours.values())), list(_cells(theirs.values()))
    for node, beside in zip(left, right, strict=False):
        found = difference(node, beside)
        if found.symbols_alone or _has_fault(node, beside, found):
            first |= found.first
            second |= found.second
        elif len(left) == len(right) > 1:
            first.add(node)
            second.add(beside)
    return first, second


def _cells(nodes: Iterable[Node]) -> Iterator[Node]:
    """Yield expressions, and each element of those that are matrices."""
    for node in nodes:
        if _is_matrix(node):
            yield from (cell for row in parts(node) for cell in parts(row))
        else:
            yield node


def _is_matrix(node: Node) -> bool:
    return isinstance(node, Call) and node.function == "matrix"


def _has_fault(one: Node, other: Node, found: ExpressionDifference) -> bool:
    """Return True if two expressions are the same except for faults that can be pointed at."""
    shares = [sum(map(size, marked)) / size(node) for node, marked in ((one, found.first), (other, found.second))]
    return max(shares) < 1 and min(shares) <= _OTHER and min(len(found.first), len(found.second)) <= _FAULTS


def _unread(label: str, form: Form, beside: Form | None, note: str) -> EquationForm:
    """Return a form as a string, cut to its differences from the form next to it."""
    text = _text(form)
    shown = pieces(text, _text(beside)) if beside else cut(text)
    return EquationForm(label, raw=shown, note=note, whole=text if len(text) > LONG else "")


def _text(form: Form) -> str:
    return "; ".join(f"{name} = {text}" for name, text in form.elements.items())


def _shown(
    label: str,
    form: Form,
    elements: _Elements,
    marked: set[Node],
    note: str,
    letters: Letters,
    *,
    like: str,
    alone: bool,
) -> EquationForm:
    """Return a form that can be read: all of it if it is short or the only one, else the marked parts."""
    groups, marks = gather_elements(elements), frozenset(marked)
    if alone or sum(map(size, elements.values())) <= _SYMBOLS:
        return EquationForm(label, _lines(groups, marks, letters), note=note)
    whole = linear(_text(form))
    if like:
        return EquationForm(label, note=note, whole=whole)
    shown = _readable_part(
        [(left, shorten_expression(part, marks)) for left, part in groups if holds(part, marks)] or _begun(groups)
    )
    return EquationForm(label, _lines(shown, marks, letters), note=note, whole=whole)


def _lines(groups: _Shown, marked: Set[Node], letters: Letters) -> list[list[str]]:
    """Return the formulas of a form: each matrix on its own line, the expressions between matrices on one."""
    lines: list[list[str]] = [[]]
    for left, part in groups:
        lines[-1].append(f"{typeset(left, marked, letters)} = {typeset(part, marked, letters)}")
        if any(map(_is_matrix, (part, *parts(part)))):
            lines.append([])
    return [line for line in lines if line]


def _begun(groups: _Shown) -> _Shown:
    """Return the first terms of a form in which nothing is marked."""
    return [
        (left, shorten_expression(part, {term for _, term in part.terms} if isinstance(part, Sum) else set()))
        for left, part in groups
    ]


def _readable_part(groups: _Shown) -> _Shown:
    """Return the shown part of a form: as many of its equations as can be read, or none."""
    sizes = accumulate(size(part) for _, part in groups)
    return [group for group, total in zip(groups, sizes, strict=True) if total <= 2 * _SYMBOLS]


def gather_elements(elements: Mapping[str, Node]) -> _Shown:
    """Return elements such as T_11 to T_44, or P_x, P_y and P_z, as one matrix, and the others as they are.

    A matrix is whole: it has an element in each row and column, from 0 or 1 on.
    """
    families: dict[str, dict[str, Node]] = {}
    for name, node in elements.items():
        match = _ELEMENT.fullmatch(name)
        family, place = (match["name"], match["place"]) if match else (name, "")
        families.setdefault(family, {})[place] = node
    found: _Shown = []
    for family, members in families.items():
        rows = _rows(members)
        if rows is not None:
            found.append((left_side(family), rows))
            continue
        found += [(left_side(f"{family}_{place}" if place else family), node) for place, node in members.items()]
    return found


def _rows(members: Mapping[str, Node]) -> Node | None:
    if tuple(members) == _VECTOR:
        return _matrix([node] for node in members.values())
    if len(members) < 4 or not all(len(place) == 2 for place in members):
        return None
    rows, columns = (sorted({place[axis] for place in members}) for axis in (0, 1))
    whole = [f"{row}{column}" for row in rows for column in columns] == sorted(members)
    if not (whole and rows[0] == columns[0] and rows[0] in "01" and len(rows) > 1):
        return None
    return _matrix([members[f"{row}{column}"] for column in columns] for row in rows)


def _matrix(rows: Iterable[Iterable[Node]]) -> Node:
    return Call("matrix", tuple(Call("row", tuple(row), 0) for row in rows), 0)


def _exchanged(found: ExpressionDifference) -> str:
    told = [
        f"${_typeset_name(ours)}$ for ${_typeset_name(theirs)}${f' ({count} times)' if count > 1 else ''}"
        for (ours, theirs), count in found.exchanged.items()
    ]
    return f", with {', '.join(told)}" if told else ""


def _typeset_name(name: str) -> str:
    return typeset(Name(name, 0))


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
