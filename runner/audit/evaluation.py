"""Vectorized evaluation of expressions over many samples."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from unicodedata import normalize  # Python reads names so

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.expressions.evaluator import Budget, Scope
from runner.base.expressions.grammar import ExpressionError
from runner.base.expressions.parser import FUNCTIONS, PRIME, Expression, as_written, parse
from runner.base.expressions.tree import symbols as names_in

_SHOWN = 6


@dataclass(frozen=True, eq=False)
class Samples(NDArrayOperatorsMixin):
    """The values of a quantity at all samples, which NumPy's signs and functions take.

    Attributes:
        values: Its values, shape (T,), or (1,) of a number.
        told: Gives the symbols at a sample in words.
    """

    values: FloatArray
    told: Callable[[int], str]

    def __array_ufunc__(self, function: np.ufunc, method: str, *inputs: "Samples") -> "Samples":
        """Apply a function.

        Raises:
            ArithmeticError: if its value is not finite at a sample; gives the first one and the symbols there.
        """
        arrays = [each.values for each in inputs]
        with np.errstate(all="ignore"):
            values = function(*arrays)
        if np.all(np.isfinite(values)):
            return Samples(values, self.told)
        sample = int(np.argmin(np.isfinite(values)))
        zero = function is np.divide and np.broadcast_arrays(*arrays)[1][sample] == 0
        reason = "division by zero" if zero else f"{function.__name__} gives no finite real number"
        raise ArithmeticError(f"{reason} at {self.told(sample)}")


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

    def told(sample: int) -> str:
        used = [name for name in dict.fromkeys(names_in(expression.root)) if name in symbols]
        values = ", ".join(f"{name} = {symbols[name][sample]:.6g}" for name in used[:_SHOWN])
        return f"sample {sample + 1}" + (f" ({values})" if values else "")

    scope = Scope(
        {name: getattr(np, name) for name in FUNCTIONS},
        {normalize("NFKC", name.replace("'", PRIME)): Samples(values, told) for name, values in symbols.items()},
        {Samples: ()},
        number=lambda value: Samples(np.array([float(value)]), told),
    )
    with as_written(expression.text, expression.python, expression.places):
        values = scope.evaluate(expression.python, Budget()).values
    count = max((len(values) for values in symbols.values()), default=1)
    return np.broadcast_to(values, (count,)).astype(float)


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
