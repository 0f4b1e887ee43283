"""Displayed forms of an audited equation, shortened, with differences marked and the elements it resembles."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from types import MappingProxyType

from runner.audit.entry import Entry, Form
from runner.audit.verdict import Judged
from runner.base.expressions.difference import Difference, difference
from runner.base.expressions.grammar import ExpressionError
from runner.base.expressions.parser import parse
from runner.base.expressions.tree import Name, Node, Sum, holds, shorten_expression, size
from runner.base.expressions.typesetting import Letters, linear, matrix, typeset
from runner.reporting.audit.marks import LONG, cut, marked_formulas, pieces
from runner.reporting.equation import EquationForm

_SYMBOLS = 40  # symbols of a form that is shown whole
_OTHER = 0.5  # share of symbols that differ from which on an expression is another, and not one with a fault
_FAULTS = 6  # differing parts up to which it is one with faults

_Elements = Mapping[str, Node]
_Matrix = Sequence[Sequence[Node]]
_Shown = list[tuple[Node, Node | _Matrix]]
_ELEMENT = re.compile(r"(?P<name>\w+?)_(?P<place>\d\d|[xyz])")
_VECTOR = ("x", "y", "z")


class Likeness:
    """The right forms of the elements of a source, by name.

    Args:
        judged: The equations of the source.
    """

    def __init__(self, judged: Iterable[Judged]) -> None:
        self._right: dict[str, Node] = {}
        for each in judged:
            entry = each.entry
            if each.verdict not in ("unreadable", "definition"):
                self._right |= {name: parse(text).root for name, text in entry.right.elements.items()}

    def words(self, entry: Entry, elements: Mapping[str, Node]) -> str:
        """Return which other element a wrong one is, but for exchanged symbols, in a sentence; nothing if none.

        Args:
            entry: An equation that is wrong.
            elements: What it says; one element can be another.
        """
        if len(elements) != 1:
            return ""
        ((name, node),) = elements.items()
        if size(node) < 2 or difference(node, self._right[name]).symbols_alone:
            return ""
        found = [(other, difference(node, right)) for other, right in self._right.items() if size(right) == size(node)]
        alike = [(other, each) for other, each in found if each.symbols_alone and other != name]
        if not alike:
            return ""
        family = name.rpartition("_")[0]
        other, best = min(alike, key=lambda each: (each[1].exchanged.total(), each[0].rpartition("_")[0] != family))
        return f"It is the right ${_typeset_name(other)}${_exchanged(best)}."


def forms_of(entry: Entry, likeness: Likeness, letters: Letters = MappingProxyType({})) -> list[EquationForm]:
    """Return the forms of an equation, each with what it does not share with the next one marked.

    Args:
        entry: The equation.
        likeness: The right forms of the equations around it.
        letters: Names as the source writes them.
    """
    forms = [form for form in (entry.printed, entry.repair, entry.corrected) if form is not None]
    read = [_read(form) for form in forms]
    marks = _marks(read)
    found = []
    for place, (form, elements) in enumerate(zip(forms, read, strict=True)):
        label = _label(entry, form)
        note = entry.repair.why if entry.repair is not None and form is entry.repair else ""
        beside = forms[1 - place] if len(forms) > 1 and place < 2 else None
        if form.math and form is entry.repair and form.math == entry.printed.math:
            found.append(EquationForm(label, note=note))
        elif form.math:
            found.append(EquationForm(label, [[_math(forms, place)]], note=note))
        elif elements is None:
            found.append(_unread(f"{label}, as the text has it", form, beside, note))
        elif form is entry.repair and read[0] is None and not (entry.printed.math or entry.corrected):
            found.append(_unread(label, form, beside, note))
        else:
            like = likeness.words(entry, elements) if len(forms) == place + 2 and entry.corrected is not None else ""
            alone = len(forms) == 1
            told = f"{note} {like}".strip()
            made = _shown(label, form, elements, marks[place], told, letters, like=like, alone=alone)
            mended = entry.repair is not None and beside is not None and form is not entry.corrected
            empty = not (made.lines or like)
            found.append(_unread(label, form, beside, note) if mended and empty else made)
    return found


def _math(forms: Sequence[Form], place: int) -> str:
    """Return a formula with what it does not share with the next one marked, the last with the one before."""
    first = min(place, len(forms) - 2)
    if first < 0 or not (forms[first].math and forms[first + 1].math):
        return forms[place].math
    return marked_formulas(forms[first].math, forms[first + 1].math)[place - first]


def _label(entry: Entry, form: Form) -> str:
    if form is entry.corrected:
        return "corrected"
    return "as printed" if form is entry.printed else "repaired"


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
    """Return what each form does not share with the next one, the last with the one before."""
    marks: list[set[Node]] = [set() for _ in read]
    for place in range(len(read) - 1):
        ours, theirs = read[place], read[place + 1]
        if ours and theirs and len(ours) == len(theirs):
            first, second = marks[place], marks[place + 1]
            first.clear()
            for one, other in zip(ours.values(), theirs.values(), strict=True):
                found = difference(one, other)
                if found.symbols_alone or _has_fault(one, other, found):
                    first |= found.first
                    second |= found.second
                elif len(ours) > 1:
                    first.add(one)
                    second.add(other)
    return marks


def _has_fault(one: Node, other: Node, found: Difference) -> bool:
    """Return whether two expressions are the same but for faults that can be pointed at."""
    shares = _share(one, found.first), _share(other, found.second)
    return max(shares) < 1 and min(shares) <= _OTHER and min(len(found.first), len(found.second)) <= _FAULTS


def _share(node: Node, marked: Set[Node]) -> float:
    return sum(map(size, marked)) / size(node)


def _unread(label: str, form: Form, beside: Form | None, note: str) -> EquationForm:
    """Return a form as text, cut to where it differs from the form beside it."""
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
    """Return a form that can be read: all of it where it is short or stands alone, else what is marked."""
    whole = linear(_text(form))
    groups, marks = gather_elements(elements), frozenset(marked)
    if alone or sum(map(size, elements.values())) <= _SYMBOLS:
        return EquationForm(label, _lines(groups, marks, letters), note=note)
    if like:
        return EquationForm(label, note=note, whole=whole)
    shown = _short(
        [(left, _cut(part, marks)) for left, part in groups if any(holds(node, marks) for node in _nodes(part))]
        or _begun(groups)
    )
    return EquationForm(label, _lines(shown, marks, letters), note=note, whole=whole)


def _lines(groups: _Shown, marked: Set[Node], letters: Letters) -> list[list[str]]:
    """Return the formulas of a form: each matrix on its own line, the expressions between matrices on one."""
    lines: list[list[str]] = [[]]
    for left, part in groups:
        if isinstance(part, Sequence):
            lines += [[f"{typeset(left, marked, letters)} = {matrix(part, marked, letters)}"], []]
        else:
            lines[-1].append(f"{typeset(left, marked, letters)} = {typeset(part, marked, letters)}")
    return [line for line in lines if line]


def _nodes(part: Node | _Matrix) -> Iterator[Node]:
    if isinstance(part, Sequence):
        for row in part:
            yield from row
    else:
        yield part


def _cut(part: Node | _Matrix, marked: Set[Node]) -> Node | _Matrix:
    if isinstance(part, Sequence):
        return [[shorten_expression(node, marked) for node in row] for row in part]
    return shorten_expression(part, marked)


def _begun(groups: _Shown) -> _Shown:
    """Return the first terms of a form in which nothing is marked."""
    return [
        (left, _cut(part, {term for _, term in part.terms} if isinstance(part, Sum) else set()))
        for left, part in groups
    ]


def _short(groups: _Shown) -> _Shown:
    """Return what is shown of a form, or nothing where it is still too long to be read."""
    return groups if sum(size(node) for _, part in groups for node in _nodes(part)) <= 2 * _SYMBOLS else []


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
            found.append((Name(family, 0), rows))
            continue
        found += [(Name(f"{family}_{place}" if place else family, 0), node) for place, node in members.items()]
    return found


def _rows(members: Mapping[str, Node]) -> _Matrix | None:
    if tuple(members) == _VECTOR:
        return [[node] for node in members.values()]
    if len(members) < 4 or not all(len(place) == 2 for place in members):
        return None
    rows, columns = (sorted({place[axis] for place in members}) for axis in (0, 1))
    whole = [f"{row}{column}" for row in rows for column in columns] == sorted(members)
    if not (whole and rows[0] == columns[0] and rows[0] in "01" and len(rows) > 1):
        return None
    return [[members[f"{row}{column}"] for column in columns] for row in rows]


def _exchanged(found: Difference) -> str:
    told = [
        f"${_typeset_name(ours)}$ for ${_typeset_name(theirs)}${f' ({count} times)' if count > 1 else ''}"
        for (ours, theirs), count in found.exchanged.items()
    ]
    return f", with {', '.join(told)}" if told else ""


def _typeset_name(name: str) -> str:
    return typeset(Name(name, 0))
