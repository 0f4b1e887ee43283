"""Symbolic scalars for code generation: sums, products, choices, and elementary functions that are bit-identical.

Sine, cosine, arctangent and exponential are made of sums and products, so that they are the same on every processor.
The polynomials are from fdlibm (Sun Microsystems, 1993: k_sin.c, k_cos.c, s_atan.c, e_exp.c). The total error is below
two units in the last place. Reduction to |r| <= pi/4 uses pi/2 in three parts (Cody and Waite, Software Manual for the
Elementary Functions, 1980). It is valid for |x| up to about 10^6 rad. A run with a joint beyond this value has
diverged.
"""

import math
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

    @_by_scalar
    def __eq__(self, other: object) -> bool:
        raise TypeError("it compares values: use backend.equal")

    __hash__ = object.__hash__


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


def library_sine(a: Value) -> Value:
    """Return the sine by the C library, whose bits may depend on the machine; see sine_cosine."""
    return Expression("sin", expression(a))


def library_cosine(a: Value) -> Value:
    """Return the cosine by the C library, whose bits may depend on the machine; see sine_cosine."""
    return Expression("cos", expression(a))


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


def are_same(one: Sequence[Value], other: Sequence[Value]) -> bool:
    """Return True if two lists of values are computed by the same operations, in the same order."""
    numbers: dict[tuple[Any, ...], int] = {}
    of_node: dict[int, int] = {}
    both_lists = [[expression(value) for value in values] for values in (one, other)]
    for node in in_order([*both_lists[0], *both_lists[1]]):
        key = (
            node.operation,
            *(of_node[id(part)] if isinstance(part, Expression) else (part,) for part in node.operands),
        )
        of_node[id(node)] = numbers.setdefault(key, len(numbers))
    first, second = ([of_node[id(value)] for value in values] for values in both_lists)
    return first == second


def all_of(conditions: Sequence[Expression]) -> Expression:
    """Return the condition that all conditions hold, at least one."""
    found = conditions[0]
    for condition in conditions[1:]:
        found = both(found, condition)
    return found


_PI_2 = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
_SINE = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
_COSINE = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
_ARCTANGENT = (
    3.33333333333329318027e-01,
    -1.99999999998764832476e-01,
    1.42857142725034663711e-01,
    -1.11111104054623557880e-01,
    9.09088713343650656196e-02,
    -7.69187620504482999495e-02,
    6.66107313738753120669e-02,
    -5.83357013379057348645e-02,
    4.97687799461593236017e-02,
    -3.65315727442169155270e-02,
    1.62858201153657823623e-02,
)
_LN_2 = (6.93147180369123816490e-01, 1.90821492927058770002e-10)
_EXPONENTIAL = (
    1.66666666666666019037e-01,
    -2.77777777770155933842e-03,
    6.61375632143793436117e-05,
    -1.65339022054652515390e-06,
    4.13813679705723846039e-08,
)
_LARGEST, _BITS = 700.0, 10  # of a decay and of its number of halvings


def sine_cosine(x: Value) -> tuple[Value, Value]:
    """Return sine and cosine of an angle, in rad."""
    if isinstance(x, float):
        return math.sin(x), math.cos(x)
    n = round_to_even(x * (2.0 / math.pi))
    r = x - n * _PI_2[0]
    r = r - n * _PI_2[1]
    r = r - n * _PI_2[2]
    z = r * r
    sine = r + r * z * _polynomial(z, _SINE)
    half = 0.5 * z
    whole = 1.0 - half
    # Add the rounding error of 1 - z/2.
    cosine = whole + ((1.0 - whole - half) + z * z * _polynomial(z, _COSINE))
    quadrant = n - 4.0 * floor(0.25 * n)
    odd = equal(n - 2.0 * floor(0.5 * n), 1.0)
    down, left = less(1.5, quadrant), less(absolute(quadrant - 1.5), 1.0)
    s, c = select(odd, cosine, sine), select(odd, sine, cosine)
    return select(down, -s, s), select(left, -c, c)


def angle_of(y: Value, x: Value) -> Value:
    """Return the angle of a point in the upper half plane from the x axis, 0 to pi, in rad; NaN at the origin."""
    size = absolute(x)
    steep = less(size, y)
    t = select(steep, size, y) / select(steep, y, size)
    # atan t = atan c + atan (t - c) / (1 + c t) with c = 0, 1/2 or 1, so that the argument is below 7/16.
    low, high = less(t, 0.4375), less(0.6875, t)
    centre = select(low, 0.0, select(high, 1.0, 0.5))
    known = select(low, 0.0, select(high, math.atan(1.0), math.atan(0.5)))
    r = (t - centre) / (1.0 + centre * t)
    z = r * r
    flat = known + (r - r * z * _polynomial(z, _ARCTANGENT))
    upper = select(steep, math.pi / 2.0 - flat, flat)
    return select(less(x, 0.0), math.pi - upper, upper)


def decay(x: Value) -> tuple[Value, Value]:
    """Return exp(-x) and 1 - exp(-x) for x >= 0; above 700 those of 700."""
    x = select(less(_LARGEST, x), _LARGEST, x)
    halvings = round_to_even(x / math.log(2.0))
    r = (halvings * _LN_2[0] - x) + halvings * _LN_2[1]
    z = r * r
    c = r - z * _polynomial(z, _EXPONENTIAL)
    grown = r - (r * c) / (c - 2.0)  # exp(r) - 1
    scale: Value = 1.0
    for bit in range(_BITS):
        half = floor(0.5 * halvings)
        scale = scale * select(equal(halvings - 2.0 * half, 1.0), 0.5**2**bit, 1.0)
        halvings = half
    return scale + scale * grown, (1.0 - scale) - scale * grown


def _polynomial(z: Value, coefficients: tuple[float, ...]) -> Value:
    """Return c_0 + c_1 z + ... by Horner's rule."""
    found: Value = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        found = found * z + coefficient
    return found
