"""Arithmetic as a tree: what the audit parses and evaluates, and what reports draw."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A number as it is written."""

    text: str
    index: int

    @property
    def value(self) -> float:
        """Its value."""
        return float(self.text)


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


def names(node: Node) -> list[Name]:
    """Return the symbols of an expression in the order in which they stand."""
    match node:
        case Name():
            return [node]
        case Number():
            return []
        case Power():
            return names(node.base) + names(node.exponent)
        case Call():
            return [name for argument in node.arguments for name in names(argument)]
        case Product():
            return [name for _, factor in node.factors for name in names(factor)]
        case Sum():
            return [name for _, term in node.terms for name in names(term)]
