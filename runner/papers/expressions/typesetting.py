"""Typst formulas of expressions: products without signs, short quotients as fractions."""

import re
from collections.abc import Mapping, Set
from types import MappingProxyType

from runner.papers.expressions.tree import Call, Name, Node, Power, Product, Sum, WrittenNumber, parts

_NAME = re.compile(r"([^\W\d_]+)(?:_?(\d\w*)|_(\w+))?('*)")
_GREEK = {
    "alpha": "α",
    "beta": "β",
    "gamma": "γ",
    "delta": "δ",
    "epsilon": "ε",
    "theta": "θ",
    "lambda": "λ",
    "mu": "μ",
    "xi": "ξ",
    "pi": "π",
    "rho": "ρ",
    "tau": "τ",
    "phi": "φ",
    "omega": "ω",
    "Lambda": "Λ",
    "Omega": "Ω",
    "Theta": "Θ",
}
_FUNCTIONS = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": 'op("atan2")', "abs": 'op("abs")'}

_TURN = re.compile(r"(R|Rot|Tra)_([xyz])")
_DIFFERENCE = re.compile(r"\d(_\d)+")
_WORD = re.compile(r"[^\W\d]\w*'*")
_LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")

Letters = Mapping[str, str]
"""Typst code by name."""
_SHORT = 160  # most characters of Typst code in a readable fraction


def symbol(name: str) -> tuple[str, str]:
    """Return the letters of a symbol with its primes, and its subscript or an empty string.

    The names of Greek letters become Greek letters. Digits at the end are a subscript, as in s12 and theta1, and so is
    the part after an underscore. s1_2 is the sine of a difference.
    """
    match = _NAME.fullmatch(name)
    if match is None:
        return name, ""
    letters, digits, suffix, primes = match.groups()
    subscript = digits or suffix or ""
    if letters.lower() in ("s", "c") and _DIFFERENCE.fullmatch(subscript):
        return letters, f"({subscript.replace('_', '−')})"
    return _GREEK.get(letters, letters) + "′" * len(primes), _GREEK.get(subscript, subscript).replace("_", ",")


def linear(text: str) -> str:
    """Return an expression as plain text with Greek letters, digits as subscripts, and products without signs."""
    return _WORD.sub(_lowered, text).replace("*", " ")


def _lowered(match: re.Match[str]) -> str:
    letters, subscript = symbol(match[0])
    lowered = subscript.translate(_LOWERED)
    return f"{letters}{lowered if subscript.isdigit() or not subscript else f'_{subscript}'}"


def typeset(node: Node, marked: Set[Node] = frozenset(), letters: Letters = MappingProxyType({})) -> str:
    """Return the Typst code of an expression.

    Brackets are plain characters: a long line can break inside them, and they do not grow with their content.

    Args:
        node: The expression.
        marked: Parts of the expression that are set in `differs(...)`.
        letters: Typst code of names that are not set by the rules of `symbol`.
    """
    return _Typesetter(marked, letters).written(node)


class _Typesetter:
    """Typesetter of one expression.

    Args:
        marked: Marked parts of the expression.
        letters: Typst code of names.
    """

    def __init__(self, marked: Set[Node], letters: Letters) -> None:
        self._marked, self._letters = marked, letters

    def written(self, node: Node) -> str:
        return self._noted(node, self._plain(node))

    def _noted(self, node: Node, text: str) -> str:
        return f"differs({text})" if self._marked and node in self._marked else text

    def _plain(self, node: Node) -> str:
        match node:
            case WrittenNumber():
                return node.text
            case Name() if node.name in self._letters:
                return self._letters[node.name]
            case Name():
                return self._name(*node.name.rstrip("]").partition("["))
            case Call(function="transpose", arguments=(Call(function="inverse", arguments=(inner,)),)):
                return f"{self._base(inner)}^(-T)"
            case Call(function="transpose" | "inverse", arguments=(inner,)):
                return f"{self._base(inner)}^({'T' if node.function == 'transpose' else '-1'})"
            case Call(function="cross", arguments=(first, second)):
                return f"{self._factor(first)} times {self._factor(second)}"
            case Call(function="skew", arguments=(inner,)):
                return f"[{self.written(inner)}]_times"
            case Call(function="log", arguments=(inner,)):
                return f"log {_bracketed(self.written(inner))}^or"
            case Call(function="sum", arguments=(letter, first, last, term)):
                return (
                    f"sum_({self.written(letter)} = {self.written(first)})^({self.written(last)}) {self._factor(term)}"
                )
            case Call(function="matrix"):
                rows = (", ".join(f"display({self.written(cell)})" for cell in parts(row)) for row in node.arguments)
                return f'mat(delim: "[", {"; ".join(rows)})'
            case Call(function="="):
                return " = ".join(map(self.written, node.arguments))
            case Call(arguments=(inner,)) if turn := _TURN.fullmatch(node.function):
                kind, axis = turn.groups()
                inside = self.written(inner)
                return f"R_{axis} {_bracketed(inside)}" if kind == "R" else f'"{kind}" \\({axis}\\, {inside}\\)'
            case Call():
                arguments = "\\, ".join(self.written(argument) for argument in node.arguments)
                if node.function == "sqrt":
                    return f"sqrt({arguments})"
                return f"{_FUNCTIONS.get(node.function, node.function)} {_bracketed(arguments)}"
            case Power():
                base = self.written(node.base)
                grouped = not isinstance(node.base, Name | WrittenNumber) and not base.startswith("sqrt")
                return f"{f'({base})' if grouped else base}^({self.written(node.exponent)})"
            case Product():
                return self._product(node)
            case Sum():
                return self._sum(node)

    def _name(self, name: str, several: str, places: str) -> str:
        """Return a symbol, with its places as a subscript if it is one of several."""
        letters, subscript = symbol(name)
        code = self._letters.get(name, f'italic("{letters}")')
        below = f'"{subscript}"' if subscript and name not in self._letters else ""
        if several:
            apart = " \\, " if re.search(r"[+-]", places) else " "
            below = f"({below} {apart.join(places.split(','))})".replace("( ", "(")
        return f"{code}_{below}" if below else code

    def _base(self, node: Node) -> str:
        text = self.written(node)
        return text if isinstance(node, Name | WrittenNumber) else f"({text})"

    def _product(self, node: Product) -> str:
        (_, first), (over, second) = node.factors[0], node.factors[-1]
        if over and len(node.factors) == 2:
            above, below = self.written(first), self.written(second)
            if len(above + below) < _SHORT:
                return f"({above}) / ({below})"
        text = self._factor(first)
        for over, factor in node.factors[1:]:
            sign = " \\/ " if over else " dot " if isinstance(factor, WrittenNumber) else " "
            grouped = over and isinstance(factor, Product)
            text += sign + (_bracketed(self.written(factor)) if grouped else self._factor(factor))
        return text

    def _sum(self, node: Sum) -> str:
        text = ""
        for place, (minus, term) in enumerate(node.terms):
            sign = "- " if minus else "+ " if place else ""
            grouped = isinstance(term, Sum) or (_is_call(term, "sum") and place + 1 < len(node.terms))
            factor = _bracketed(self._plain(term)) if grouped else self._plain(term)
            text += (" " if place else "") + self._noted(term, sign + factor)
        return text

    def _factor(self, node: Node) -> str:
        grouped = isinstance(node, Sum) or _is_call(node, "cross", "sum")
        return self._noted(node, _bracketed(self._plain(node))) if grouped else self.written(node)


def _is_call(node: Node, *functions: str) -> bool:
    return isinstance(node, Call) and node.function in functions


def _bracketed(text: str) -> str:
    space = " " if text.startswith("(") else ""  # otherwise Typst reads both brackets as one
    return f"\\({space}{text}\\)"
