"""Expressions in double braces inside a string, such as `{{ mass / 2 }}`."""

import re
from collections.abc import Callable, Iterator
from typing import Any

from runner.base.expressions.evaluator import Budget, Scope
from runner.base.expressions.grammar import ExpressionError

_PIECE = re.compile(r""""(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|[{}]|[^"'{}]+|.""", re.DOTALL)


def insertions(text: str) -> Iterator[tuple[int, int]]:
    """Yield begin and end of each expression in a text, braces included; braces within one are its own.

    Raises:
        ExpressionError: if one is not closed.
    """
    stop = 0
    while (start := text.find("{{", stop)) >= 0:
        stop = _closed(text, start + 2)
        if stop < 0:
            raise ExpressionError(text, start, "{{ is not closed; write }} after the expression")
        yield start, stop


def fill(text: str, scope: Scope, budget: Budget, shown: Callable[[Any], str] = str) -> str:
    """Return a text with the value of each expression in its place.

    Args:
        text: The text.
        scope: What its expressions reach.
        budget: What they may spend.
        shown: Gives the text of a value.

    Raises:
        ExpressionError: if one is not closed, or has no value; see Scope.evaluate.
    """
    parts, end = [], 0
    for start, stop in insertions(text):
        parts += [text[end:start], shown(scope.evaluate(text[start + 2 : stop - 2].strip(), budget))]
        end = stop
    return "".join([*parts, text[end:]])


def _closed(text: str, start: int) -> int:
    """Return where an expression ends that begins behind its braces, -1 where it does not."""
    depth = 0
    for piece in _PIECE.finditer(text, start):
        if depth == 0 and piece[0] == "}" and text.startswith("}}", piece.start()):
            return piece.start() + 2
        depth += {"{": 1, "}": -1}.get(piece[0], 0)
    return -1
