"""Expressions evaluated over many samples at once."""

import operator
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from runner.errors import RunnerError, nearest
from runner.expressions.parser import Expression, ExpressionError, parse
from runner.expressions.tree import Call, Name, Node, Number, Power, Product, names

FloatArray = NDArray[np.float64]

_LISTED = 40
_SHOWN = 6


def evaluate(expression: Expression, symbols: Mapping[str, FloatArray]) -> FloatArray:
    """Return the values of an expression at all samples.

    Args:
        expression: What to evaluate.
        symbols: Values of each name at the samples, shape (T,) each.

    Returns:
        Its values, shape (T,).

    Raises:
        ExpressionError: If a name is unknown, or if a division by zero, a root or an inverse sine or cosine outside
            its domain, or a number without bound turns up at a sample; the message names the position and the sample.
    """
    count = max((len(values) for values in symbols.values()), default=1)
    with np.errstate(all="ignore"):
        return np.broadcast_to(_Evaluation(expression, symbols).value(expression.root), (count,)).astype(float)


def evaluate_all(texts: Mapping[str, str], symbols: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Return the values of expressions by name, shape (T,) each.

    Raises:
        RunnerError: If one cannot be read or evaluated; names it.
    """
    found = {}
    for name, text in texts.items():
        try:
            found[name] = evaluate(parse(text), symbols)
        except ExpressionError as error:
            raise RunnerError(f"{name}, {error}") from error
    return found


def with_symbols(values: Mapping[str, FloatArray], texts: Mapping[str, str]) -> Mapping[str, FloatArray]:
    """Return values by name with those of expressions beside; each may use the ones before it."""
    for name, text in texts.items():
        values = {**values, **evaluate_all({name: text}, values)}
    return values


class _Evaluation:
    def __init__(self, expression: Expression, symbols: Mapping[str, FloatArray]) -> None:
        self._expression, self._symbols = expression, symbols

    def value(self, node: Node) -> FloatArray:
        match node:
            case Number():
                return np.array([node.value])
            case Name():
                return self._named(node)
            case Call():
                return self._call(node)
            case Power():
                base, exponent = self.value(node.base), self.value(node.exponent)
                self._refuse((base == 0) & (exponent < 0), node.index, "division by zero (a negative power of 0)")
                return self._finite(base**exponent, node.index, "a power that is no finite real number")
            case Product():
                return self._product(node)
            case _:
                first, *rest = ((-1.0 if minus else 1.0) * self.value(term) for minus, term in node.terms)
                return self._finite(sum(rest, first), node.index, "a sum that is not finite")

    def _named(self, node: Name) -> FloatArray:
        if node.name not in self._symbols:
            known = ", ".join(list(self._symbols)[:_LISTED]) + (", ..." if len(self._symbols) > _LISTED else "")
            told = f"unknown name '{node.name}'{nearest(node.name, self._symbols)}; names: {known}"
            raise ExpressionError(self._expression.text, node.index, told)
        return self._symbols[node.name]

    def _product(self, node: Product) -> FloatArray:
        total = np.ones(1)
        for over, factor in node.factors:
            value = self.value(factor)
            if over:
                self._refuse(value == 0, factor.index, "division by zero")
            total = (operator.truediv if over else operator.mul)(total, value)
        return self._finite(total, node.index, "a product that is not finite")

    def _call(self, node: Call) -> FloatArray:
        arguments = [self.value(argument) for argument in node.arguments]
        result = np.asarray(getattr(np, node.function)(*arguments), dtype=float)  # the parser knows what may be called
        return self._finite(result, node.index, f"{node.function} of a number outside its domain")

    def _finite(self, values: FloatArray, index: int, reason: str) -> FloatArray:
        self._refuse(~np.isfinite(values), index, reason)
        return values

    def _refuse(self, bad: NDArray[np.bool_], index: int, reason: str) -> None:
        if not np.any(bad):
            return
        sample = int(np.argmax(bad))
        used = list(dict.fromkeys(name.name for name in names(self._expression.root) if name.name in self._symbols))
        values = ", ".join(f"{name} = {self._symbols[name][sample]:.6g}" for name in used[:_SHOWN])
        at = f" ({values})" if values else ""
        raise ExpressionError(self._expression.text, index, f"{reason} at sample {sample + 1}{at}")
