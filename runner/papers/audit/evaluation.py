"""Vectorized evaluation of expression trees over many samples."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial, reduce
from types import MappingProxyType
from typing import Any, NamedTuple, NoReturn
from unicodedata import normalize  # Python reads names so

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.papers.audit.derivations import along, rotation, translation
from runner.papers.expressions.evaluator import OperationBudget
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.parser import FUNCTIONS, ParsedExpression, parse
from runner.papers.expressions.tree import Call, Name, Node, Power, Product, Sum, WrittenNumber, at_places, parts, start
from runner.papers.expressions.tree import symbols as symbols_in

_OPERATIONS = 10_000
_SHOWN = 6  # numbers in a message
_LISTED = 40  # names in a message
_NONE: Mapping[str, int] = MappingProxyType({})


class Numbered(NamedTuple):
    """An expression, with the numbers that letters in square brackets stand for, such as the i of `Z[i-1]`."""

    text: str
    numbers: Mapping[str, int] = _NONE


class SampleValues(Mapping[str, FloatArray]):
    """Values of symbols at the samples, and those of expressions, each evaluated when it is first used.

    Args:
        symbols: Values of each symbol, shape (T,), (T, n) or (T, m, n).
        known: Other names with their expressions. Of two with one name, the symbol counts.

    Attributes:
        count: Number of samples T.
        found: Values of the symbols, and of the expressions so far.
        used: Names of the expressions that were used.
    """

    def __init__(self, symbols: Mapping[str, FloatArray], known: Mapping[str, Numbered] = MappingProxyType({})) -> None:
        self.found = {normalize("NFKC", name): values for name, values in symbols.items()}
        self._known, self._within = known, list[str]()
        self.count = max(map(len, self.found.values()), default=1)
        self.used: set[str] = set()

    def __getitem__(self, name: str) -> FloatArray:
        if name not in self.found:
            self.found[name] = self.sides(name, self._known[name])[-1]
            self.used.add(name)
        return self.found[name]

    def __iter__(self) -> Iterator[str]:
        return iter({**self.found, **self._known})

    def __len__(self) -> int:
        return len({**self.found, **self._known})

    def __contains__(self, name: object) -> bool:
        return name in self.found or name in self._known

    def sides(self, name: str, written: Numbered) -> list[FloatArray]:
        """Return the values of each side of a named expression.

        Raises:
            RunnerError: If it cannot be read or evaluated, or if it uses itself; names it.
        """
        if name in self._within:
            raise RunnerError(f"{' uses '.join((*self._within, name))}: an element cannot use itself")
        self._within.append(name)
        try:
            return evaluate_sides(parse(written.text), self, written.numbers)
        except ExpressionError as error:
            raise RunnerError(f"{name}, {error}") from error
        finally:
            self._within.pop()


def evaluate(
    expression: ParsedExpression, symbols: Mapping[str, FloatArray], numbers: Mapping[str, int] = _NONE
) -> FloatArray:
    """Return the values of an expression at all samples; those of its last side, if it has several.

    Args:
        expression: What to evaluate.
        symbols: Values of each name at the samples, shape (T,), (T, n) or (T, m, n) each.
        numbers: What letters in square brackets stand for.

    Returns:
        Its values, shape (T,), (T, n) or (T, m, n).

    Raises:
        ExpressionError: If a name is unknown, shapes do not fit, or if a division by zero, a root or an inverse sine
            or cosine outside its domain, or a number without bound turns up at a sample; the message names the
            position and the sample.
    """
    return evaluate_sides(expression, symbols, numbers)[-1]


def evaluate_sides(
    expression: ParsedExpression, symbols: Mapping[str, FloatArray], numbers: Mapping[str, int] = _NONE
) -> list[FloatArray]:
    """Return the same for each side of an equation such as `a = b`."""
    root, values = expression.root, symbols if isinstance(symbols, SampleValues) else SampleValues(symbols)
    sides = root.arguments if isinstance(root, Call) and root.function == "=" else (root,)
    evaluation = _Evaluation(expression, values)
    found = [evaluation.of(side, numbers) for side in sides]
    return [np.broadcast_to(each, (values.count, *each.shape[1:])).astype(float) for each in found]


def evaluate_all(texts: Mapping[str, str], symbols: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Return symbols by name with the values of expressions, which may use each other.

    Raises:
        RunnerError: If one cannot be read or evaluated, or uses itself; names it.
    """
    values = SampleValues(symbols, {name: Numbered(text) for name, text in texts.items()})
    return {name: values[name] for name in values}


class _Evaluation:
    """Evaluation of one expression; a number has shape (T,) or (1,).

    Args:
        expression: The expression.
        values: Values of its names.
    """

    def __init__(self, expression: ParsedExpression, values: SampleValues) -> None:
        self._expression, self._values, self._budget = expression, values, OperationBudget(_OPERATIONS)

    def of(self, node: Node, numbers: Mapping[str, int]) -> FloatArray:
        """Return the values of a part of the expression, where letters in square brackets stand for numbers."""
        match node:
            case WrittenNumber():
                return np.array([float(node.text)])
            case Name():
                return self._named(node, numbers)
            case Call(
                function="sum", arguments=(Name(name=letter), WrittenNumber(text=first), WrittenNumber(text=last), term)
            ):
                each = ({**numbers, letter: k} for k in range(int(first), int(last) + 1))
                return reduce(partial(self._applied, term, np.add), (self.of(term, found) for found in each))
            case Call(function="matrix"):
                blocks = [[self.of(cell, numbers) for cell in parts(row)] for row in node.arguments]
                return self._applied(node, _matrix, *blocks)
            case Call():
                function = _FUNCTIONS.get(node.function) or getattr(np, node.function)
                return self._applied(node, function, *(self.of(each, numbers) for each in node.arguments))
            case Power():
                return self._applied(node.exponent, np.power, *(self.of(each, numbers) for each in parts(node)))
            case Product(factors=((_, first), *rest)):
                value = self.of(first, numbers)
                for over, factor in rest:
                    value = self._applied(factor, _divide if over else _multiply, value, self.of(factor, numbers))
                return value
            case Sum(terms=terms):
                value = np.zeros(1)
                for minus, term in terms:
                    value = self._applied(term, np.subtract if minus else np.add, value, self.of(term, numbers))
                return value
            case _:
                raise AssertionError(node)

    def _named(self, node: Name, numbers: Mapping[str, int]) -> FloatArray:
        name = at_places(node.name, numbers)
        if name not in self._values:
            known = (*FUNCTIONS, *self._values)
            listed = f"; names: {', '.join(known)}" if len(known) <= _LISTED else ""
            self._refuse(node, f"no name '{name}'{nearest(name, known)}{listed}")
        return self._values[name]

    def _applied(self, node: Node, function: Callable[..., FloatArray], *values: Any) -> FloatArray:
        try:
            self._budget.spend(1)
            if not isinstance(function, np.ufunc) and function not in (_multiply, _divide):
                return function(*values)
            with np.errstate(all="ignore"):
                found = np.asarray(function(*_alike(values) if isinstance(function, np.ufunc) else values))
        except (ArithmeticError, ValueError) as error:
            self._refuse(node, f"has no value: {error}")
        if np.isfinite(found).all():
            return found
        lost = ~_finite(found)
        for value in values:
            lost &= _finite(value)  # an inverse that does not exist has been counted
        if lost.any():
            sample, name = int(np.argmax(lost)), function.__name__.lstrip("_")
            zero = function is _divide and values[1][sample % len(values[1])] == 0
            reason = "division by zero" if zero else f"{name} gives no finite real number"
            self._refuse(node, f"has no value: {reason} at {self._told(sample)}")
        return found

    def _told(self, sample: int) -> str:
        found = [(name, self._values.found.get(name)) for name in dict.fromkeys(symbols_in(self._expression.root))]
        numbers = [(name, values[sample]) for name, values in found if values is not None and values.ndim == 1]
        values = ", ".join(f"{name} = {value:.6g}" for name, value in numbers[:_SHOWN])
        return f"sample {sample + 1}" + (f" ({values})" if values else "")

    def _refuse(self, node: Node, reason: str) -> NoReturn:
        raise ExpressionError(self._expression.text, start(node), reason) from None


def _finite(values: FloatArray) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(values).reshape(len(values), -1).all(axis=1))


# Numbers, vectors and matrices.


def size_of(values: FloatArray) -> str:
    """Return a description of the size of values, such as "a vector of 3"."""
    kinds = "a number", "a vector of {}", "a {} by {} matrix"
    return kinds[values.ndim - 1].format(*values.shape[1:])


def _alike(values: Sequence[FloatArray]) -> list[FloatArray]:
    """Return values with one number of axes; numbers apply to each element."""
    if len({each.shape[1:] for each in values if each.ndim > 1}) > 1:
        raise ValueError(f"{' and '.join(map(size_of, values))} do not fit")
    most = max(each.ndim for each in values)
    return [each.reshape(len(each), *(each.shape[1:] or (most - 1) * (1,))) for each in values]


def _multiply(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return a product; that of one row and one column is a number."""
    if 1 in (first.ndim, second.ndim):
        return np.asarray(np.multiply(*_alike([first, second])))
    if not (first.ndim == 3 and first.shape[2] == second.shape[1]):
        raise ValueError(f"{size_of(first)} @ {size_of(second)} do not fit")
    found = along(first, second) if second.ndim == 2 else np.matmul(first, second)
    return found.reshape(len(found)) if found.size == len(found) else found


def _divide(first: FloatArray, second: FloatArray) -> FloatArray:
    if second.ndim > 1:
        raise ValueError(f"{size_of(first)} / {size_of(second)} do not fit")
    return np.asarray(np.divide(*_alike([first, second])))


def _matrix(*rows: Sequence[FloatArray]) -> FloatArray:
    """Return a matrix of blocks, which has a row for each sequence; a number 0 is a block of any size."""
    if len({len(row) for row in rows}) > 1:
        raise ValueError("the rows of the matrix have different lengths")
    count = max(len(block) for row in rows for block in row)
    sizes = np.array([[_block(block) for block in row] for row in rows])
    heights, widths = [_onesize_of(row) for row in sizes[:, :, 0]], [_onesize_of(column) for column in sizes[:, :, 1].T]
    found = np.zeros((count, sum(heights), sum(widths)))
    top = 0
    for row, height in zip(rows, heights, strict=True):
        left = 0
        for block, width in zip(row, widths, strict=True):
            shaped = block if block.ndim == 3 else block.reshape(len(block), -1, 1)
            found[:, top : top + height, left : left + width] = shaped
            left += width
        top += height
    return found[:, :, 0] if found.shape[2] == 1 else found


def _block(block: FloatArray) -> tuple[int, int]:
    """Return the rows and columns of a block; 0 for a block of any size."""
    if block.ndim == 1:
        return (1, 1) if block.any() else (0, 0)
    return block.shape[1], block.shape[2] if block.ndim == 3 else 1


def _onesize_of(sizes: NDArray[np.int_]) -> int:
    found = {int(size) for size in sizes if size} or {1}
    if len(found) > 1:
        raise ValueError(f"blocks of {' and '.join(map(str, sorted(found)))} rows or columns do not fit")
    return found.pop()


def _checked(values: FloatArray, name: str, fits: bool, wanted: str) -> None:
    if not fits:
        raise ValueError(f"{name} takes {wanted}, not {size_of(values)}")


def _transpose(matrix: FloatArray) -> FloatArray:
    """Return the transpose; that of a vector is a row."""
    _checked(matrix, "transpose", matrix.ndim > 1, "a matrix")
    return matrix[:, None] if matrix.ndim == 2 else matrix.transpose(0, 2, 1)


def _inverse(matrix: FloatArray) -> FloatArray:
    """Return the inverse, no number at samples where it does not exist."""
    _checked(matrix, "inverse", matrix.ndim == 3 and matrix.shape[1] == matrix.shape[2], "a square matrix")
    found = np.full(matrix.shape, np.nan)
    for sample, each in enumerate(matrix):
        with suppress(np.linalg.LinAlgError):
            found[sample] = np.linalg.inv(each)
    if np.isnan(found).all():
        raise ValueError("the matrix is singular at every sample")
    return found


def _cross(*vectors: FloatArray) -> FloatArray:
    for each in vectors:
        _checked(each, "cross", each.shape[1:] == (3,), "two vectors of 3")
    return np.cross(vectors[0], vectors[1])


def _skew(vector: FloatArray) -> FloatArray:
    _checked(vector, "skew", vector.shape[1:] == (3,), "a vector of 3")
    return np.cross(vector[:, None], np.eye(3)).transpose(0, 2, 1)


def _log(matrix: FloatArray) -> FloatArray:
    _checked(matrix, "log", matrix.shape[1:] == (3, 3), "a rotation")
    return np.asarray(Rotation.from_matrix(matrix).as_rotvec())


def _about(axis: str, size: int) -> Callable[[FloatArray], FloatArray]:
    return lambda angle: rotation(axis, angle)[:, :size, :size]


def _shift(axis: str) -> Callable[[FloatArray], FloatArray]:
    return lambda length: np.concatenate([translation(axis, float(each)) for each in length])


_FUNCTIONS: Mapping[str, Callable[..., FloatArray]] = {
    "transpose": _transpose, "inverse": _inverse, "cross": _cross, "skew": _skew, "log": _log,
    **{f"R_{axis}": _about(axis, 3) for axis in "xyz"},
    **{f"Rot_{axis}": _about(axis, 4) for axis in "xyz"},
    **{f"Tra_{axis}": _shift(axis) for axis in "xyz"},
}  # fmt: skip
