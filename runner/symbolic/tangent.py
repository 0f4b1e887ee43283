"""Forward-mode differentiation of programs with respect to a parameter.

The tangent of a number is its derivative with respect to the parameter. Each operation has a rule, as in Griewank and
Walther, Evaluating Derivatives (2008), table 3.3. A choice has the tangent of the selected branch. Rounding to whole
numbers has tangent zero. A clipped torque therefore does not depend on the unclipped one. A sine has the tangent for
the quadrant of its argument.
"""

from collections.abc import Callable, Sequence
from typing import Any

from runner.symbolic.code import ACTING, ROWS, TABLE, Block, Part, Repeat
from runner.symbolic.expression import Expression, Value, expression, in_order, less, place, select
from runner.symbolic.program import Expressed

_STEPS = ("less", "equal", "and", "not", "rint", "floor", "constant")


def with_tangents(program: Expressed, varies: Callable[[str, int], bool]) -> Expressed:
    """Return a program with tangents: in each space except the table, the tangents follow the numbers.

    Args:
        program: The program.
        varies: Function of space and index that returns True if the tangent of that number may differ from 0.
    """
    widths = {space: width if space == TABLE else 2 * width for space, width in program.widths.items()}
    tangents = _Tangents(program.widths, varies)
    ticks, between = tangents.of_parts(program.ticks), tangents.of_parts(program.between)
    return Expressed(ticks, between, widths, program.errors)


class _Tangents:
    def __init__(self, widths: Any, varies: Callable[[str, int], bool]) -> None:
        self._widths, self._varies = widths, varies
        self._known: dict[int, Value] = {}

    def of_parts(self, parts: Sequence[Part]) -> list[Part]:
        """Return parts that also compute the tangents."""
        found: list[Part] = []
        for part in parts:
            if isinstance(part, Repeat):
                found.append(Repeat(self.of_parts(part.parts), part.times, part.until_zero, part.tabled))
            else:
                own = [(space, self._widths[space] + index, self.of(value)) for space, index, value in part.outputs]
                found.append(Block([*part.outputs, *own]))
        return found

    def of(self, value: Value) -> Value:
        """Return the tangent of a value; the float 0 if it is always zero."""
        if not isinstance(value, Expression):
            return 0.0
        for node in in_order([value]):
            if id(node) not in self._known:
                self._known[id(node)] = self._rule(node)
        return self._known[id(value)]

    def _rule(self, node: Expression) -> Value:
        operation, operands = node.operation, node.operands
        if operation == "place":
            space, index = operands
            own = ROWS if space == ACTING else space
            varies = space != TABLE and self._varies(own, index)
            return place(space, self._widths[own] + index) if varies else 0.0
        if operation in _STEPS:
            return 0.0
        if operation == "select":
            condition, yes, no = operands
            return _chosen(condition, self._known[id(yes)], self._known[id(no)])
        changes = [self._known[id(operand)] for operand in operands]
        if all(not isinstance(change, Expression) for change in changes):
            return 0.0
        return _RULES[operation](node, *operands, *changes)


def _chosen(condition: Expression, yes: Value, no: Value) -> Value:
    if not (isinstance(yes, Expression) or isinstance(no, Expression)):
        return 0.0
    return select(condition, expression(yes), expression(no))


def _root(node: Value, a: Value, da: Value) -> Value:
    # At 0 the slope is infinite; it is replaced by 0, so that no NaN propagates.
    return select(less(0.0, a), da / (2.0 * node), 0.0)


_RULES: dict[str, Callable[..., Value]] = {
    "fadd": lambda _, a, b, da, db: da + db,
    "fsub": lambda _, a, b, da, db: da - db,
    "fmul": lambda _, a, b, da, db: da * b + a * db,
    "fdiv": lambda node, a, b, da, db: (da - node * db) / b,
    "fneg": lambda _, a, da: -da,
    "fabs": lambda _, a, da: select(less(a, 0.0), -da, da),
    "sqrt": _root,
}
