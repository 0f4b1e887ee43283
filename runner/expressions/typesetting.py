"""Expressions as formulas in Typst mathematics: products without signs, short quotients as fractions."""

import re

from runner.expressions.tree import Call, Name, Node, Number, Power, Product, Sum

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

_SHORT = 160  # characters of Typst code that still make a readable fraction


def symbol(name: str) -> tuple[str, str]:
    """Return a symbol's letters, Greek where it is spelt so, with its primes; and its subscript, or an empty text.

    Digits at the end are a subscript, as in s12 and theta1, and so is what follows an underscore.
    """
    match = _NAME.fullmatch(name)
    if match is None:
        return name, ""
    letters, digits, suffix, primes = match.groups()
    subscript = digits or suffix or ""
    return _GREEK.get(letters, letters) + "′" * len(primes), _GREEK.get(subscript, subscript).replace("_", ",")


def typeset(node: Node) -> str:
    """Return an expression in Typst mathematics.

    Brackets are plain characters, which a long line can break between, and do not grow with what they hold.
    """
    match node:
        case Number():
            return node.text
        case Name():
            letters, subscript = symbol(node.name)
            return f'italic("{letters}")' + (f'_"{subscript}"' if subscript else "")
        case Call():
            arguments = ", ".join(typeset(argument) for argument in node.arguments)
            if node.function == "sqrt":
                return f"sqrt({arguments})"
            return f"{_FUNCTIONS.get(node.function, node.function)} {_bracketed(arguments)}"
        case Power():
            base = typeset(node.base)
            grouped = not isinstance(node.base, Name | Number) and not base.startswith("sqrt")
            return f"{f'({base})' if grouped else base}^({typeset(node.exponent)})"
        case Product():
            return _product(node)
        case Sum():
            return _sum(node)


def _product(node: Product) -> str:
    (_, first), (over, second) = node.factors[0], node.factors[-1]
    if over and len(node.factors) == 2:
        above, below = typeset(first), typeset(second)
        if len(above + below) < _SHORT:
            return f"({above}) / ({below})"
    text = _factor(first)
    for over, factor in node.factors[1:]:
        sign = " \\/ " if over else " dot " if isinstance(factor, Number) else " "
        text += sign + (_bracketed(typeset(factor)) if over and isinstance(factor, Product) else _factor(factor))
    return text


def _sum(node: Sum) -> str:
    text = ""
    for place, (minus, term) in enumerate(node.terms):
        sign = "- " if minus else "+ " if place else ""
        text += (" " if place else "") + sign + _factor(term)
    return text


def _factor(node: Node) -> str:
    return _bracketed(typeset(node)) if isinstance(node, Sum) else typeset(node)


def _bracketed(text: str) -> str:
    return f"\\({text}\\)"
