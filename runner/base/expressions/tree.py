"""Expression tree: numbers, names, calls, powers, products and sums, and its shortened form."""

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A number as it is written."""

    text: str
    index: int


@dataclass(frozen=True)
class Name:
    """A symbol, bound to values when the expression is evaluated."""

    name: str
    index: int


@dataclass(frozen=True)
class Call:
    """A function of the list with its arguments."""

    function: str
    arguments: tuple["Node", ...]
    index: int


@dataclass(frozen=True)
class Power:
    """A base raised to an exponent."""

    base: "Node"
    exponent: "Node"
    index: int


@dataclass(frozen=True)
class Product:
    """Factors; each is divided by where its flag says so, from left to right."""

    factors: tuple[tuple[bool, "Node"], ...]
    index: int


@dataclass(frozen=True)
class Sum:
    """Terms; each is subtracted where its flag says so."""

    terms: tuple[tuple[bool, "Node"], ...]
    index: int


Node = Number | Name | Call | Power | Product | Sum


def parts(node: Node) -> Sequence[Node]:
    """Return what an expression is made of directly."""
    match node:
        case Number() | Name():
            return ()
        case Call():
            return node.arguments
        case Power():
            return (node.base, node.exponent)
        case Product():
            return [factor for _, factor in node.factors]
        case Sum():
            return [term for _, term in node.terms]


def symbols(node: Node) -> Iterator[str]:
    """Yield the names, numbers and functions of an expression, in the order in which they stand."""
    match node:
        case Number():
            yield node.text
        case Name():
            yield node.name
        case Call():
            yield node.function
    for part in parts(node):
        yield from symbols(part)


def size(node: Node) -> int:
    """Return how many symbols an expression has."""
    return sum(1 for _ in symbols(node))


ELLIPSIS = "…"
_SHORT = 6  # symbols of a part that is shown though nothing in it is marked
_MOST = 3  # marked terms in a row that are shown

_Term = tuple[bool, Node]


def shorten_expression(node: Node, marked: Set[Node]) -> Node:
    """Return an expression in which dots stand for what is not marked, and for most of many marked terms in a row."""
    if node in marked or size(node) <= _SHORT:
        return node
    match node:
        case Sum():
            return Sum(tuple(_few(node.terms, marked)), node.index)
        case Product():
            return Product(tuple((over, _inner(factor, marked)) for over, factor in node.factors), node.index)
        case Call():
            return Call(node.function, tuple(_inner(each, marked) for each in node.arguments), node.index)
        case Power():
            return Power(_inner(node.base, marked), _inner(node.exponent, marked), node.index)
        case Number() | Name():
            return node


def holds(node: Node, marked: Set[Node]) -> bool:
    """Return whether something in an expression is marked."""
    return node in marked or any(holds(part, marked) for part in parts(node))


def _inner(node: Node, marked: Set[Node]) -> Node:
    if size(node) > _SHORT and not holds(node, marked):
        return _dots(node, bracketed=isinstance(node, Sum))
    return shorten_expression(node, marked)


def _few(terms: Sequence[_Term], marked: Set[Node]) -> Iterator[_Term]:
    """Yield the terms in which something is marked, and dots once for each run of others."""
    run, dotted = 0, False
    for minus, term in terms:
        run = run + 1 if term in marked else 0
        if run > _MOST or not holds(term, marked):
            if not dotted:
                yield False, _dots(term)
            dotted = True
            continue
        yield minus, shorten_expression(term, marked)
        dotted = False


def _dots(node: Node, *, bracketed: bool = False) -> Name:
    return Name(f"({ELLIPSIS})" if bracketed else ELLIPSIS, node.index)
