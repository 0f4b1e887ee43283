"""Search for the correct element that a wrong element equals up to exchanged symbols."""

from collections.abc import Iterable, Mapping

from runner.audit.entry import Entry
from runner.audit.verdict import Judged
from runner.base.expressions.difference import Difference, difference
from runner.base.expressions.parser import parse
from runner.base.expressions.tree import Name, Node, size
from runner.base.expressions.typesetting import typeset


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
                right = entry.corrected or entry.repair or entry.printed
                self._right |= {name: parse(text).root for name, text in right.elements.items()}

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
        other, best = min(alike, key=lambda each: (each[1].exchanged.total(), not _kin(each[0], name)))
        return f"It is the right ${_math(other)}${_exchanged(best)}."


def _kin(one: str, other: str) -> bool:
    return one.rpartition("_")[0] == other.rpartition("_")[0]


def _exchanged(found: Difference) -> str:
    told = [
        f"${_math(ours)}$ for ${_math(theirs)}${f' ({count} times)' if count > 1 else ''}"
        for (ours, theirs), count in found.exchanged.items()
    ]
    return f", with {', '.join(told)}" if told else ""


def _math(name: str) -> str:
    return typeset(Name(name, 0))
