"""Differences between two expressions, symbol by symbol."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from runner.papers.expressions.tree import Call, Name, Node, Power, Product, Sum, WrittenNumber, symbols

_ALIKE = 0.3  # fraction of common symbols above which two terms are compared as a pair

_Part = tuple[bool, Node]


@dataclass(frozen=True)
class ExpressionDifference:
    """Differences between two expressions.

    Attributes:
        first: Parts of the first expression that are missing in the second; empty if they are equal.
        second: Parts of the second expression that are missing in the first.
        exchanged: Number of exchanges by pairs of a symbol of the first and the symbol in its place in the second.
        symbols_alone: True if the expressions differ in exchanged symbols only.
    """

    first: frozenset[Node]
    second: frozenset[Node]
    exchanged: Counter[tuple[str, str]]
    symbols_alone: bool


def difference(first: Node, second: Node) -> ExpressionDifference:
    """Return the differences between two expressions; the order of terms and factors does not matter."""
    found = _Finder()
    found.compare(first, second)
    return ExpressionDifference(
        frozenset(found.first),
        frozenset(found.second),
        found.exchanged,
        len(found.first) == len(found.second) == found.exchanged.total(),
    )


class _Finder:
    """Recursive comparison of two expressions that collects the differences."""

    def __init__(self) -> None:
        self.first: set[Node] = set()
        self.second: set[Node] = set()
        self.exchanged: Counter[tuple[str, str]] = Counter()

    def compare(self, first: Node, second: Node) -> None:
        if _shape(first) == _shape(second):
            return
        match first, second:
            case Name(), Name():
                self.exchanged[first.name, second.name] += 1
                self._differ(first, second)
            case (Sum(), _) | (_, Sum()):
                self._align(first, _terms(first), second, _terms(second))
            case (Product(), _) | (_, Product()):
                self._align(first, _factors(first), second, _factors(second))
            case Power(), Power():
                self.compare(first.base, second.base)
                self.compare(first.exponent, second.exponent)
            case Call(), Call() if (first.function, len(first.arguments)) == (second.function, len(second.arguments)):
                for one, other in zip(first.arguments, second.arguments, strict=True):
                    self.compare(one, other)
            case Call(), Call() if _arc(first) and _arc(second):
                self._compare_arcs(first, second)
            case _:
                self._differ(first, second)

    def _compare_arcs(self, first: Call, second: Call) -> None:
        """Compare atan of a quotient with atan2; with equal arguments, the two calls differ as a whole."""
        before = len(self.first), len(self.second)
        for one, other in zip(_arc(first), _arc(second), strict=True):
            self.compare(one, other)
        if (len(self.first), len(self.second)) == before:
            self._differ(first, second)

    def _differ(self, first: Node, second: Node) -> None:
        self.first.add(first)
        self.second.add(second)

    def _align(self, first: Node, ours: Sequence[_Part], second: Node, theirs: Sequence[_Part]) -> None:
        """Pair terms or factors: equal ones first, then those with the most common symbols."""
        left, right = _without_common(ours, theirs)
        pairs: list[tuple[Node, Node]] = []
        alone = []
        for flag, node in left:
            candidates = [each for each in right if each[0] == flag]
            best = max(candidates, key=lambda each: _alike(node, each[1]), default=None)
            if best is None or _alike(node, best[1]) < _ALIKE:
                alone.append(node)
                continue
            right = [each for each in right if each is not best]
            pairs.append((node, best[1]))
        if not pairs and len(alone) == len(ours) and len(right) == len(theirs):
            self._differ(first, second)
            return
        for one, other in pairs:
            self.compare(one, other)
        self.first.update(alone)
        self.second.update(node for _, node in right)


def _arc(node: Call) -> Sequence[Node]:
    """Return the two arguments of atan2, or of a quotient in atan; empty for any other call."""
    if node.function == "atan2":
        return node.arguments
    argument = node.arguments[0]
    if node.function in ("atan", "arctan") and isinstance(argument, Product):
        overs = [over for over, _ in argument.factors]
        if overs == [False, True]:
            return [factor for _, factor in argument.factors]
    return ()


def _terms(node: Node) -> Sequence[_Part]:
    return node.terms if isinstance(node, Sum) else [(False, node)]


def _factors(node: Node) -> Sequence[_Part]:
    return node.factors if isinstance(node, Product) else [(False, node)]


def _without_common(ours: Sequence[_Part], theirs: Sequence[_Part]) -> tuple[list[_Part], list[_Part]]:
    right = list(theirs)
    left = []
    for flag, node in ours:
        equal = next((each for each in right if each[0] == flag and _shape(each[1]) == _shape(node)), None)
        if equal is None:
            left.append((flag, node))
        else:
            right = [each for each in right if each is not equal]
    return left, right


def _alike(first: Node, second: Node) -> float:
    """Return the fraction of symbols that two expressions have in common, from 0 to 1."""
    if isinstance(first, Name) and isinstance(second, Name):
        return 1.0
    one, other = Counter(symbols(first)), Counter(symbols(second))
    return (one & other).total() / max(1, (one | other).total())


def _shape(node: Node) -> tuple[object, ...]:
    """Return an expression without the positions of its parts."""
    match node:
        case WrittenNumber():
            return (float(node.text),)
        case Name():
            return (node.name,)
        case Product():
            return ("*", *((over, _shape(factor)) for over, factor in node.factors))
        case Sum():
            return ("+", *((minus, _shape(term)) for minus, term in node.terms))
        case Call():
            return (node.function, *map(_shape, node.arguments))
        case Power():
            return ("^", _shape(node.base), _shape(node.exponent))
