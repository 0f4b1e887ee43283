"""Sandboxed evaluator of expressions in files, with a limit on every step.

An expression has Python's grammar and can use only the names in its scope. Values can be numbers, strings, booleans,
None, and lists, tuples and mappings of these. Values can also be instances of listed classes. The expression can read
the listed fields and call the listed methods of these classes. For a mapping, `x.key` means `x["key"]`. An expression
can call the functions in its scope, or pass them to another function as a measure. The evaluator checks every
attribute against the list, so other attributes of an object are not accessible.
"""

import ast
import operator
import re
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from numbers import Real
from typing import Any, NoReturn

import numpy as np

from runner.base.errors import RunnerError, nearest
from runner.papers.expressions.grammar import EXCERPT, LONGEST, ExpressionError, chain, dotted, index_of, parse

_BITS = 63  # of a whole number
_WHOLE = 2**_BITS
_LISTED = 40  # names
_FEW = 20  # most numbers of a list in a formatted string
_FORM = re.compile(r"%(?:%|[-+]?\d{0,2}(?:\.\d{1,2})?([sdfge]))")
_ARITHMETIC: Mapping[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.MatMult: operator.matmul,
}
_COMPARISONS: Mapping[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


class OperationBudget:
    """Remaining operations for the expressions of a file; unlike time, the count is the same on all machines.

    Args:
        operations: Number of allowed operations.
    """

    def __init__(self, operations: int = 100_000) -> None:
        self._allowed = self._left = operations

    def spend(self, operations: int) -> None:
        """Subtract operations from the remaining ones.

        Raises:
            OverflowError: if fewer operations remain.
        """
        self._left -= operations
        if self._left < 0:
            raise OverflowError(f"the expressions of a file take more than {self._allowed} operations")


@dataclass(frozen=True)
class Scope:
    """Names and classes that an expression can access.

    Attributes:
        functions: Functions by name, which an expression can call or pass on as a measure.
        values: Values by name; a name can have dots, as in "robot.mass".
        members: Accessible fields and methods by class; instances of these classes support arithmetic.
        handed: Other classes whose instances an expression can only pass on.
        number: Function that returns the value of a number in the expression.
    """

    functions: Mapping[str, Callable[..., Any]]
    values: Mapping[str, Any]
    members: Mapping[type, Sequence[str]] = field(default_factory=dict)
    handed: tuple[type, ...] = ()
    number: Callable[[Any], Any] = operator.pos

    def evaluate(self, text: str, budget: OperationBudget) -> Any:
        """Return the value of an expression.

        Args:
            text: The expression.
            budget: Allowed operations.

        Raises:
            ExpressionError: if the text is not an expression, a name does not exist, a value has the wrong type or is
                too large, or the budget is exhausted.
            RunnerError: if a function raises it.
        """
        return _Evaluation(self, text, budget).of(parse(text))


class _Evaluation:
    """Evaluation of one expression; `of` returns the value of a node."""

    def __init__(self, scope: Scope, text: str, budget: OperationBudget) -> None:
        self._scope, self._text, self._budget = scope, text, budget
        self._kinds = tuple(scope.members)

    def of(self, node: ast.expr) -> Any:
        with self._placed(node):
            self._budget.spend(1)
            value = self._of(node)
            self._budget.spend(self._sized(value, node))
            return value

    @contextmanager
    def _placed(self, node: ast.expr) -> Iterator[None]:
        try:
            yield
        except (ArithmeticError, ValueError, TypeError) as error:
            told = error.args[-1] if error.args else type(error).__name__
            raise self._refused(node, f"has no value: {told}") from None

    def _of(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant():
                return self._scope.number(node.value) if _is_number(node.value) else node.value
            case ast.Name() | ast.Attribute() if (name := dotted(node)) in self._scope.values:
                return self._scope.values[name]
            case ast.Name():
                return self._function(node, node.id)
            case ast.Attribute():
                return self._member(node)
            case ast.List() | ast.Tuple():
                items = list(self._spread(node.elts))
                return items if isinstance(node, ast.List) else tuple(items)
            case ast.Dict():
                return {self._key(key, node): self.of(value) for key, value in zip(node.keys, node.values, strict=True)}
            case ast.Subscript():
                return self._item(node)
            case ast.Call():
                return self._call(node)
            case ast.BinOp():
                first, row = chain(node)
                value = self.of(first)
                for each in row:
                    right = self.of(each.right)
                    with self._placed(each.right):
                        value = self._worked_out(each, value, right)
                return value
            case ast.UnaryOp(op=ast.USub() | ast.UAdd()):
                value = self.of(node.operand)
                if not self._has_arithmetic(value):
                    self._refuse(node, f"a sign needs a number after it; found {type(value).__name__}")
                return -value if isinstance(node.op, ast.USub) else value
            case ast.UnaryOp() if isinstance(node.op, ast.Not):
                return not self._truth(node.operand)
            case ast.BoolOp():
                wanted = isinstance(node.op, ast.Or)
                return wanted if any(self._truth(each) is wanted for each in node.values) else not wanted
            case ast.IfExp():
                return self.of(node.body if self._truth(node.test) else node.orelse)
            case ast.Compare():
                return self._compared(node)
        place = index_of(node, self._text)
        return self._refuse(node, f"'{self._text[place : place + EXCERPT]}' is not allowed in an expression")

    def _function(self, node: ast.expr, name: str) -> Callable[..., Any]:
        if name not in self._scope.functions:
            known = (*self._scope.functions, *self._scope.values)
            listed = f"; names: {', '.join(known)}" if len(known) <= _LISTED else ""
            self._refuse(node, f"no name '{name}'{nearest(name, known)}{listed}")
        return self._scope.functions[name]

    def _member(self, node: ast.Attribute) -> Any:
        name = dotted(node)
        if name and not {name.partition(".")[0]} & {*self._scope.functions, *self._scope.values}:
            self._function(node, name)  # raises
        owner = self.of(node.value)
        if isinstance(owner, dict):
            return self._of_mapping(owner, node.attr, node)
        known = self._scope.members.get(type(owner), ())
        if node.attr not in known:
            of = f"a value of type {type(owner).__name__}"
            there = f"{nearest(node.attr, known)}; there are: {', '.join(known)}" if known else ""
            self._refuse(node, f"{of} has no '{node.attr}' that can be read{there}")
        return getattr(owner, node.attr)

    def _call(self, node: ast.Call) -> Any:
        if isinstance(node.func, ast.Name):
            function = self._function(node.func, node.func.id)
        elif isinstance(node.func, ast.Attribute):
            function = self._member(node.func)
        else:
            self._refuse(node, "only named functions can be called")
        arguments = list(self._spread(node.args))
        options = {each.arg: self.of(each.value) for each in node.keywords if each.arg is not None}
        if len(options) < len(node.keywords) or not callable(function):
            told = "two stars, or a name twice, are not allowed here"
            self._refuse(node, told if callable(function) else "this is not a function")
        try:
            return function(*arguments, **options)
        except (RunnerError, ArithmeticError):
            raise
        except Exception as error:
            told = traceback.format_exception_only(error)[-1].strip()
            raise self._refused(node, told) from error

    def _spread(self, nodes: Sequence[ast.expr]) -> Iterator[Any]:
        for node in nodes:
            if not isinstance(node, ast.Starred):
                yield self.of(node)
                continue
            items = self.of(node.value)
            if not isinstance(items, list | tuple):
                self._refuse(node, f"a star needs a list after it; found {type(items).__name__}")
            yield from items

    def _key(self, node: ast.expr | None, inside: ast.expr) -> Any:
        value = None if node is None else self.of(node)
        if not isinstance(value, str | int | float):
            self._refuse(node or inside, "a key of a mapping must be a string or a number")
        return value

    def _item(self, node: ast.Subscript) -> Any:
        owner, key = self.of(node.value), self._key(node.slice, node)
        if isinstance(owner, dict):
            return self._of_mapping(owner, key, node)
        if not isinstance(owner, list | tuple | np.ndarray) or type(key) is not int:
            self._refuse(node, f"no item {key!r} of a value of type {type(owner).__name__}")
        if not -len(owner) <= key < len(owner):
            self._refuse(node, f"no item {key} of {len(owner)}")
        return owner[key]

    def _of_mapping(self, owner: Mapping[Any, Any], key: Any, node: ast.expr) -> Any:
        if key not in owner:
            texts = [str(each) for each in owner][:_LISTED]
            self._refuse(node, f"has no '{key}'{nearest(str(key), texts)}; there are: {', '.join(texts)}")
        return owner[key]

    def _worked_out(self, node: ast.BinOp, left: Any, right: Any) -> Any:
        """Return the value of one operation in a chain."""
        work = _ARITHMETIC.get(type(node.op))
        if isinstance(node.op, ast.Mod) and isinstance(left, str):
            return self._formatted(left, right if isinstance(right, tuple) else (right,), node.right)
        if work is operator.add and any(isinstance(left, kind) and isinstance(right, kind) for kind in (str, list)):
            if len(left) + len(right) > LONGEST:
                raise OverflowError(f"a string or list of {len(left) + len(right)}; allowed: up to {LONGEST}")
            return left + right
        if work is None or not self._has_arithmetic(left, right):
            sides = f"{type(left).__name__} and {type(right).__name__}"
            self._refuse(node.right, f"cannot compute with {sides}")
        if work is operator.pow and type(left) is type(right) is int and abs(left) > 1 and right > _BITS:
            raise OverflowError(f"a whole number of more than {_BITS} bits")
        value = self._answer(work(left, right), node.right)
        self._sized(value, node.right)
        return value

    def _compared(self, node: ast.Compare) -> Any:
        sides = [self.of(each) for each in (node.left, *node.comparators)]
        found = [self._pair(kind, *pair, node) for kind, pair in zip(node.ops, pairwise(sides), strict=True)]
        if len(found) > 1 and not all(isinstance(each, bool) for each in found):
            self._refuse(node, "measured values can only be compared in pairs; write a list of two conditions")
        return found[0] if len(found) == 1 else all(found)

    def _pair(self, kind: ast.cmpop, left: Any, right: Any, node: ast.expr) -> Any:
        alike = self._has_arithmetic(left, right) or (isinstance(left, str) and isinstance(right, str))
        if type(kind) in _COMPARISONS and alike:
            found = _COMPARISONS[type(kind)](left, right)
            return found if isinstance(found, self._kinds) else bool(found)
        plain = all(side is None or isinstance(side, str | Real) for side in (left, right))
        if isinstance(kind, ast.Eq | ast.NotEq | ast.Is | ast.IsNot) and plain:
            return bool(left == right) is isinstance(kind, ast.Eq | ast.Is)
        if isinstance(kind, ast.In | ast.NotIn) and isinstance(left, str) and isinstance(right, str | list | tuple):
            return (left in right) is isinstance(kind, ast.In)
        return self._refuse(node, f"{type(left).__name__} and {type(right).__name__} cannot be compared like this")

    def _answer(self, value: Any, node: ast.expr) -> Any:
        if value is NotImplemented or isinstance(value, complex):
            self._refuse(node, "has no value: not a real number")
        return value

    def _formatted(self, form: str, values: tuple[Any, ...], node: ast.expr) -> str:
        """Return a string with values instead of %s, %d, %.3f and so on."""
        kinds = [kind for kind in _FORM.findall(form) if kind]
        if "%" in _FORM.sub("", form) or len(kinds) != len(values):
            self._refuse(node, f"{len(kinds)} of the forms %s, %d, %.3f, %g, %e for {len(values)} value(s); %% is a %")
        shown: list[Any] = []
        for kind, value in zip(kinds, values, strict=True):
            if not (_is_number(value) or (kind == "s" and self._is_shown(value))):
                self._refuse(node, f"%{kind} does not show {type(value).__name__}")
            shown.append(str(value) if kind == "s" else value)
        if len(form) + sum(len(each) if isinstance(each, str) else EXCERPT for each in shown) > LONGEST:
            raise OverflowError(f"a string of more than {LONGEST} characters")
        return form % tuple(shown)

    def _is_shown(self, value: Any) -> bool:
        few = isinstance(value, list | tuple) and len(value) <= _FEW and all(map(_is_number, value))
        return few or isinstance(value, (str, bool, *self._kinds))

    def _has_arithmetic(self, *values: Any) -> bool:
        return all(_is_number(value) or isinstance(value, self._kinds) for value in values)

    def _truth(self, node: ast.expr) -> bool:
        value = self.of(node)
        if not isinstance(value, bool):
            self._refuse(node, f"{type(value).__name__} is neither true nor false")
        return value

    def _sized(self, value: Any, node: ast.expr) -> int:
        """Return the total number of items of a value after checking the class of each item."""
        left, count = [value], 0
        while left:
            each = left.pop()
            if each is None or type(each) is float or (type(each) is int and -_WHOLE < each < _WHOLE):
                continue
            if isinstance(each, list | tuple | dict):
                count += len(each)
                left += [] if count > LONGEST else each.values() if isinstance(each, dict) else each
            elif isinstance(each, str):
                count = max(count, len(each) // EXCERPT)
                if len(each) > LONGEST:
                    raise OverflowError(f"a string of {len(each)} characters; allowed: up to {LONGEST}")
            elif type(each) is int:
                raise OverflowError(f"a whole number of more than {_BITS} bits")
            elif not (isinstance(each, (Real, *self._kinds, *self._scope.handed)) or callable(each)):
                self._refuse(node, f"an expression cannot hold a value of type {type(each).__name__}")
            if count > LONGEST:
                raise OverflowError(f"more than {LONGEST} items; allowed: up to {LONGEST}")
        return count

    def _refused(self, node: ast.expr, reason: str) -> ExpressionError:
        return ExpressionError(self._text, index_of(node, self._text), reason)

    def _refuse(self, node: ast.expr, reason: str) -> NoReturn:
        raise self._refused(node, reason)


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)
