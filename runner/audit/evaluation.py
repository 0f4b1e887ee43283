"""Vectorized evaluation of expressions over many samples."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from unicodedata import normalize  # Python reads names so

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from runner.audit.truth import along
from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.expressions.evaluator import Budget, Scope
from runner.base.expressions.grammar import ExpressionError
from runner.base.expressions.parser import FUNCTIONS, PRIME, Expression, as_written, parse
from runner.base.expressions.tree import symbols as symbols_in

_SHOWN = 6


@dataclass(frozen=True, eq=False)
class Samples(NDArrayOperatorsMixin):
    """The values of a quantity at all samples, which NumPy's signs and functions take.

    Attributes:
        values: Its values, shape (T,), (T, n) of a vector, (T, m, n) of a matrix, or (1,) of a number.
        told: Gives the symbols at a sample in words.
    """

    values: FloatArray
    told: Callable[[int], str]

    def __array_ufunc__(self, function: np.ufunc, method: str, *inputs: "Samples") -> "Samples":
        """Apply a function; numbers apply to each element of a vector or matrix.

        Raises:
            ArithmeticError: if its value is not finite at a sample; gives the first one and the symbols there.
            ValueError: if vectors or matrices do not fit.
        """
        arrays = [each.values for each in inputs]
        with np.errstate(all="ignore"):
            values = _applied(function, arrays)
        if np.all(np.isfinite(values)):
            return Samples(values, self.told)
        sample = int(np.argmin(np.isfinite(values).reshape(len(values), -1).all(axis=1)))
        zero = function is np.divide and np.broadcast_arrays(*arrays)[1][sample] == 0
        reason = "division by zero" if zero else f"{function.__name__} gives no finite real number"
        raise ArithmeticError(f"{reason} at {self.told(sample)}")


def _applied(function: np.ufunc, arrays: list[FloatArray]) -> FloatArray:
    """Return the values of a function of several quantities, each of which is a number, a vector or a matrix."""
    shapes = [array.shape[1:] for array in arrays]
    if function is np.matmul:
        if not (len(shapes[0]) == 2 and shapes[1] and shapes[0][1] == shapes[1][0]):
            raise ValueError(f"{_size(shapes[0])} @ {_size(shapes[1])} do not fit")
        return along(*arrays) if len(shapes[1]) == 1 else np.asarray(np.matmul(*arrays))
    if len({shape for shape in shapes if shape}) > 1:
        raise ValueError(f"{' and '.join(map(_size, shapes))} do not fit")
    most = max(map(len, shapes))
    return np.asarray(function(*(array.reshape(len(array), *(array.shape[1:] or most * (1,))) for array in arrays)))


def _size(shape: tuple[int, ...]) -> str:
    kinds = "a number", "a vector of {}", "a {} by {} matrix"
    return kinds[len(shape)].format(*shape)


def _of_matrix(values: FloatArray, name: str, fits: bool, wanted: str) -> None:
    if not fits:
        raise ArithmeticError(f"{name} takes {wanted}, not {_size(values.shape[1:])}")


def _transpose(matrix: Samples) -> Samples:
    _of_matrix(matrix.values, "transpose", matrix.values.ndim == 3, "a matrix")
    return Samples(matrix.values.transpose(0, 2, 1), matrix.told)


def _inverse(matrix: Samples) -> Samples:
    shape = matrix.values.shape[1:]
    _of_matrix(matrix.values, "inverse", len(shape) == 2 and shape[0] == shape[1], "a square matrix")
    try:
        return Samples(np.asarray(np.linalg.inv(matrix.values), dtype=float), matrix.told)
    except np.linalg.LinAlgError:
        raise ArithmeticError("the matrix is singular at a sample") from None


def _cross(*vectors: Samples) -> Samples:
    for each in vectors:
        _of_matrix(each.values, "cross", each.values.shape[1:] == (3,), "two vectors of 3")
    return Samples(np.cross(vectors[0].values, vectors[1].values), vectors[0].told)


_OF_MATRICES: Mapping[str, Callable[..., Samples]] = {"transpose": _transpose, "inverse": _inverse, "cross": _cross}


def evaluate(expression: Expression, symbols: Mapping[str, FloatArray]) -> FloatArray:
    """Return the values of an expression at all samples.

    Args:
        expression: What to evaluate.
        symbols: Values of each name at the samples, shape (T,), (T, n) or (T, m, n) each.

    Returns:
        Its values, shape (T,), (T, n) or (T, m, n).

    Raises:
        ExpressionError: If a name is unknown, or if a division by zero, a root or an inverse sine or cosine outside
            its domain, or a number without bound turns up at a sample; the message names the position and the sample.
    """

    def told(sample: int) -> str:
        used = [name for name in dict.fromkeys(symbols_in(expression.root)) if name in symbols]
        numbers = [name for name in used if symbols[name].ndim == 1]
        values = ", ".join(f"{name} = {symbols[name][sample]:.6g}" for name in numbers[:_SHOWN])
        return f"sample {sample + 1}" + (f" ({values})" if values else "")

    scope = Scope(
        {name: _OF_MATRICES[name] if name in _OF_MATRICES else getattr(np, name) for name in FUNCTIONS},
        {normalize("NFKC", name.replace("'", PRIME)): Samples(values, told) for name, values in symbols.items()},
        {Samples: ()},
        number=lambda value: Samples(np.array([float(value)]), told),
    )
    with as_written(expression.text, expression.python, expression.places):
        values = scope.evaluate(expression.python, Budget()).values
    count = max((len(values) for values in symbols.values()), default=1)
    return np.broadcast_to(values, (count, *values.shape[1:])).astype(float)


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


def names_in(texts: Mapping[str, str]) -> set[str]:
    """Return the names, numbers and functions of expressions."""
    return {name for text in texts.values() for name in symbols_in(parse(text).root)}


def evaluate_used(
    texts: Mapping[str, str], known: Mapping[str, str], symbols: Mapping[str, FloatArray], above: tuple[str, ...] = ()
) -> dict[str, FloatArray]:
    """Return the values of expressions whose names are symbols, or else known expressions.

    Raises:
        RunnerError: as `evaluate_all`, or if an expression uses itself.
    """
    values = symbols
    for name in sorted((names_in(texts) & set(known)) - set(symbols)):
        if name in above:
            raise RunnerError(f"{' uses '.join((*above, name))}: an element cannot use itself")
        values = {**values, **evaluate_used({name: known[name]}, known, symbols, (*above, name))}
    return evaluate_all(texts, values)


def with_symbols(values: Mapping[str, FloatArray], texts: Mapping[str, str]) -> Mapping[str, FloatArray]:
    """Return values by name with those of expressions beside; each may use the ones before it."""
    for name, text in texts.items():
        values = {**values, **evaluate_all({name: text}, values)}
    return values
