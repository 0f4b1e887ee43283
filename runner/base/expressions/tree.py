"""Expression tree: numbers, names, calls, powers, products and sums."""

from collections.abc import Iterator, Sequence
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
