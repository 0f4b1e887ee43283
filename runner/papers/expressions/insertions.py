"""Expressions in double braces inside a string, such as `{{ mass / 2 }}`."""

import re
from collections.abc import Callable, Iterator
from typing import Any

from runner.papers.expressions.evaluator import OperationBudget, Scope
from runner.papers.expressions.grammar import ExpressionError

_PIECE = re.compile(r""""(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|[{}]|[^"'{}]+|.""", re.DOTALL)


def insertions(text: str) -> Iterator[tuple[int, int]]:
    """Yield the start and end of each expression in a string, including its braces; it can contain braces itself.

    Raises:
        ExpressionError: if an expression is not closed.
    """
    stop = 0
    while (start := text.find("{{", stop)) >= 0:
        stop = _closed(text, start + 2)
        if stop < 0:
            raise ExpressionError(text, start, "{{ is not closed; write }} after the expression")
        yield start, stop


def fill(text: str, scope: Scope, budget: OperationBudget, shown: Callable[[Any], str] = str) -> str:
    """Return a string in which the value of each expression replaces the expression.

    Args:
        text: The string.
        scope: Names that the expressions can access.
        budget: Operations that the expressions can use.
        shown: Function that formats a value.

    Raises:
        ExpressionError: if an expression is not closed or has no value; see Scope.evaluate.
    """
    parts, end = [], 0
    for start, stop in insertions(text):
        parts += [text[end:start], shown(scope.evaluate(text[start + 2 : stop - 2].strip(), budget))]
        end = stop
    return "".join([*parts, text[end:]])


def _closed(text: str, start: int) -> int:
    """Return the end of an expression after its closing braces, from its start; -1 if it is not closed."""
    depth = 0
    for piece in _PIECE.finditer(text, start):
        if depth == 0 and piece[0] == "}" and text.startswith("}}", piece.start()):
            return piece.start() + 2
        depth += {"{": 1, "}": -1}.get(piece[0], 0)
    return -1
