"""Symbolic scalars for code generation: sums, products, functions and choices."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, Union

import numpy as np

Value = Union["Expression", float]


def _by_scalar(method: Callable[..., Any]) -> Callable[..., Any]:
    """Leave arrays to NumPy, which calls the operator for each entry."""
    return lambda self, other: NotImplemented if isinstance(other, np.ndarray) else method(self, other)


class Expression:
    """The result of one operation on others; it works with NumPy's operators on arrays of objects.

    Attributes:
        operation: Name of the operation; see runner/symbolic/code.py.
        operands: Operands: expressions, the number of a constant, or the space and index of a slot.
    """

    __slots__ = ("operands", "operation")

    def __init__(self, operation: str, *operands: Any) -> None:
        self.operation, self.operands = operation, operands

    @_by_scalar
    def __add__(self, other: Value) -> Value:
        return self if _is(other, 0.0) else Expression("fadd", self, expression(other))

    @_by_scalar
    def __radd__(self, other: float) -> Value:
        return self if _is(other, 0.0) else Expression("fadd", expression(other), self)

    @_by_scalar
    def __sub__(self, other: Value) -> Value:
        return self if _is(other, 0.0) else Expression("fsub", self, expression(other))

    @_by_scalar
    def __rsub__(self, other: float) -> Value:
        return -self if _is(other, 0.0) else Expression("fsub", expression(other), self)

    @_by_scalar
    def __mul__(self, other: Value) -> Value:
        if _is(other, 0.0):
            return 0.0
        if _is(other, 1.0):
            return self
        return -self if _is(other, -1.0) else Expression("fmul", self, expression(other))

    __rmul__ = __mul__

    @_by_scalar
    def __truediv__(self, other: Value) -> Value:
        return self if _is(other, 1.0) else Expression("fdiv", self, expression(other))

    @_by_scalar
    def __rtruediv__(self, other: float) -> Value:
        return 0.0 if _is(other, 0.0) else Expression("fdiv", expression(other), self)

    def __neg__(self) -> Value:
        return Expression("fneg", self)

    def __pow__(self, power: int) -> Value:
        if power != 2:
            raise TypeError(f"the power {power}: only squares are known")
        return Expression("fmul", self, self)

    def __bool__(self) -> bool:
        raise TypeError("it branches on a value: use backend.choose")

    def __lt__(self, other: object) -> bool:
        raise TypeError("it compares values: use backend.less")

    __gt__ = __le__ = __ge__ = __lt__


def expression(value: Value) -> Expression:
    """Return a number as a constant, or an expression unchanged."""
    return value if isinstance(value, Expression) else Expression("constant", float(value))


def _is(value: Value, number: float) -> bool:
    return not isinstance(value, Expression) and value == number


def place(space: str, index: int) -> Expression:
    """Return the number in a slot of a space of a program; see Program."""
    return Expression("place", space, index)


def places(space: str, first: int, count: int) -> list[Expression]:
    """Return the numbers in consecutive slots."""
    return [place(space, index) for index in range(first, first + count)]


def less(a: Value, b: Value) -> Expression:
    """Return the condition a < b; false if one is NaN."""
    return Expression("less", expression(a), expression(b))


def equal(a: Value, b: Value) -> Expression:
    """Return the condition a = b; false if one is NaN."""
    return Expression("equal", expression(a), expression(b))


def both(a: Expression, b: Expression) -> Expression:
    """Return the condition that two conditions hold."""
    return Expression("and", a, b)


def negated(condition: Expression) -> Expression:
    """Return the condition that another does not hold."""
    return Expression("not", condition)


def select(condition: Expression, yes: Value, no: Value) -> Value:
    """Return one of two numbers."""
    return yes if yes is no else Expression("select", condition, expression(yes), expression(no))


def sqrt(a: Value) -> Value:
    """Return the square root."""
    return Expression("sqrt", expression(a))


def absolute(a: Value) -> Value:
    """Return the absolute value."""
    return Expression("fabs", expression(a))


def round_to_even(a: Value) -> Value:
    """Return the nearest integer; the even one if two are equally near."""
    return Expression("rint", expression(a))


def floor(a: Value) -> Value:
    """Return the largest integer that is not greater."""
    return Expression("floor", expression(a))


def in_order(outputs: Iterable[Expression]) -> Iterator[Expression]:
    """Yield the expressions that these outputs depend on, and the outputs, each after its operands."""
    seen: set[int] = set()
    for output in outputs:
        waiting: list[tuple[Expression, bool]] = [(output, False)]
        while waiting:
            node, ready = waiting.pop()
            if id(node) in seen:
                continue
            if ready:
                seen.add(id(node))
                yield node
            else:
                waiting.append((node, True))
                waiting += [(operand, False) for operand in reversed(node.operands) if isinstance(operand, Expression)]


def all_of(conditions: Sequence[Expression]) -> Expression:
    """Return the condition that all conditions hold, at least one."""
    found = conditions[0]
    for condition in conditions[1:]:
        found = both(found, condition)
    return found
