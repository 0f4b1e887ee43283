"""Expressions in double braces, as `{{ mass / 2 }}`: arithmetic on numbers with names, read without running code."""

import ast
import math
import re
from collections.abc import Callable, Mapping

from runner.errors import RunnerError, nearest

Level = str | int | float
"""What a name stands for: a number, or a text that may only stand alone."""

_BRACES = re.compile(r"\{\{(.*?)\}\}")
_LONGEST = 200  # characters of an expression
_OPERATORS: Mapping[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
}


class ExpressionError(RunnerError):
    """An expression that has no value; the message says why."""


def fill(text: str, scope: Mapping[str, Level]) -> str:
    """Return a text with its expressions worked out, numbers with nine digits at most: 1.0 is put in as "1".

    Args:
        text: The text, as "robot.mass={{ mass / 2 }}".
        scope: What each name stands for.

    Raises:
        ExpressionError: if an expression is none, or has a name that stands for nothing.
    """

    def put_in(match: re.Match[str]) -> str:
        value = _evaluate(match[1].strip(), scope)
        return value if isinstance(value, str) else f"{value:.9g}"

    if "{{" in _BRACES.sub("", text):
        raise ExpressionError(f"'{text}' has double braces that are not closed")
    return _BRACES.sub(put_in, text)


def alone(text: str) -> str | None:
    """Return the name that an override consists of, as "mass" of "{{ mass }}"; None where there is more to it."""
    match = re.fullmatch(r"\{\{\s*([\w.]+)\s*\}\}", text)
    return match[1] if match else None


def names_in(text: str) -> set[str]:
    """Return the names in the expressions of a text."""
    return {name for match in _BRACES.finditer(text) for name in re.findall(r"[A-Za-z_][\w.]*", match[1])}


def _evaluate(text: str, scope: Mapping[str, Level]) -> Level:
    try:
        node = ast.parse(text, mode="eval").body if len(text) <= _LONGEST else None
    except (SyntaxError, ValueError):
        node = None
    if node is None:
        raise ExpressionError(f"{{{{ {text} }}}} is no expression of at most {_LONGEST} characters")
    name = _dotted(node)
    try:
        value = _value_of(name, scope) if name else _number(node, scope)
        if isinstance(value, str) or math.isfinite(value):
            return value
        raise OverflowError("it is not finite")
    except (ZeroDivisionError, OverflowError, TypeError, ValueError) as error:
        raise ExpressionError(f"{{{{ {text} }}}} has no value: {error}") from None


def _dotted(node: ast.expr) -> str:
    """Return the name that a node is, dots included, or an empty text."""
    if isinstance(node, ast.Attribute):
        owner = _dotted(node.value)
        return f"{owner}.{node.attr}" if owner else ""
    return node.id if isinstance(node, ast.Name) else ""


def _value_of(name: str, scope: Mapping[str, Level]) -> Level:
    if name not in scope:
        known = ", ".join(scope) or "none"
        raise ExpressionError(f"'{name}' is neither an axis nor a value{nearest(name, scope)}; known: {known}")
    return scope[name]


def _number(node: ast.expr, scope: Mapping[str, Level]) -> float:
    if name := _dotted(node):
        value = _value_of(name, scope)
        if isinstance(value, str):
            raise ExpressionError(f"'{name}' is the text '{value}', which no arithmetic takes")
        return value
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        number: float = node.value  # type: ignore[assignment]
        return number
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        return _OPERATORS[type(node.op)](_number(node.left, scope), _number(node.right, scope))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        value = _number(node.operand, scope)
        return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "round":
        numbers = [_number(each, scope) for each in node.args]
        if len(numbers) in (1, 2) and not node.keywords:
            return round(numbers[0], *[int(digits) for digits in numbers[1:]])
    raise ExpressionError(f"{{{{ {ast.unparse(node)} }}}}: only numbers, names, + - * / and round(x, digits) are known")
