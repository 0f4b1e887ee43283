"""Expression tree: numbers, names, calls, powers, products and sums, and its shortened form."""

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import partial


@dataclass(frozen=True)
class WrittenNumber:
    """Number as written."""

    text: str
    index: int


@dataclass(frozen=True)
class Name:
    """Symbol, which has a value when the expression is evaluated; `Z[i-1]` is one of several."""

    name: str
    index: int


@dataclass(frozen=True)
class Call:
    """Call of an allowed function, or a "matrix" of calls of "row", or "=" with the sides of an equation."""

    function: str
    arguments: tuple["Node", ...]
    index: int


@dataclass(frozen=True)
class Power:
    """Base raised to an exponent."""

    base: "Node"
    exponent: "Node"
    index: int


@dataclass(frozen=True)
class Product:
    """Factors from left to right; True marks a divisor."""

    factors: tuple[tuple[bool, "Node"], ...]
    index: int


@dataclass(frozen=True)
class Sum:
    """Terms; True marks a subtracted term."""

    terms: tuple[tuple[bool, "Node"], ...]
    index: int


Node = WrittenNumber | Name | Call | Power | Product | Sum


def parts(node: Node) -> Sequence[Node]:
    """Return the direct operands of an expression."""
    match node:
        case WrittenNumber() | Name():
            return ()
        case Call():
            return node.arguments
        case Power():
            return (node.base, node.exponent)
        case Product():
            return [factor for _, factor in node.factors]
        case Sum():
            return [term for _, term in node.terms]


def start(node: Node) -> int:
    """Return the position of the first character of an expression; a power's own is that of its sign."""
    return start(node.base) if isinstance(node, Power) else node.index


def at_places(name: str, numbers: Mapping[str, int]) -> str:
    """Return the name that a name such as `Z[i-1]` stands for if its letters are numbers: Z_1 for i = 2.

    A letter that has no number stays: P[i,n] is P_2n.
    """
    letters, _, places = name.partition("[")
    found = "".join(_place(place, numbers) for place in places.rstrip("]").split(","))
    return f"{letters}_{found}" if places else name


def _place(place: str, numbers: Mapping[str, int]) -> str:
    if place[:1] not in numbers:
        return place
    return str(numbers[place[0]] + int(place[1:] or 0))


_FRAMES = ("matrix", "row", "=")


def symbols(node: Node) -> Iterator[str]:
    """Yield the names, numbers and functions of an expression, each function before its arguments."""
    match node:
        case WrittenNumber():
            yield node.text
        case Name():
            yield node.name
        case Call() if node.function not in _FRAMES:
            yield node.function
    for part in parts(node):
        yield from symbols(part)


def size(node: Node) -> int:
    """Return the number of symbols in an expression."""
    return sum(1 for _ in symbols(node))


ELLIPSIS = "…"
_SHORT = 6  # most symbols of an unmarked part that is shown
_MOST = 3  # most consecutive marked terms that are shown

_Term = tuple[bool, Node]


def shorten_expression(node: Node, marked: Set[Node]) -> Node:
    """Return an expression with dots for unmarked parts, and for the rest of a long run of marked terms."""
    if node in marked or size(node) <= _SHORT:
        return node
    match node:
        case Sum():
            return Sum(tuple(_few(node.terms, marked)), node.index)
        case Product():
            return Product(tuple((over, _inner(factor, marked)) for over, factor in node.factors), node.index)
        case Call(function="matrix" | "="):
            return Call(node.function, tuple(shorten_expression(each, marked) for each in node.arguments), node.index)
        case Call():
            inner = partial(_inner, marked=marked, bracketed=node.function != "row")
            return Call(node.function, tuple(map(inner, node.arguments)), node.index)
        case Power():
            return Power(_inner(node.base, marked), _inner(node.exponent, marked), node.index)
        case WrittenNumber() | Name():
            return node


def holds(node: Node, marked: Set[Node]) -> bool:
    """Return True if any part of an expression is marked."""
    return node in marked or any(holds(part, marked) for part in parts(node))


def _inner(node: Node, marked: Set[Node], bracketed: bool = True) -> Node:
    if size(node) > _SHORT and not holds(node, marked):
        return _dots(node, bracketed=bracketed and isinstance(node, Sum))
    return shorten_expression(node, marked)


def _few(terms: Sequence[_Term], marked: Set[Node]) -> Iterator[_Term]:
    """Yield the terms that contain a marked part, and dots once for each run of other terms."""
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
