"""Expression grammar: Python without loops, functions, assignments and slices, with size limits."""

import ast
import re
import warnings
from collections.abc import Mapping
from functools import lru_cache

from runner.base.errors import RunnerError

LONGEST = 10_000  # characters of an expression and of a string, items of a list and of the lists in it
EXCERPT = 30  # characters that a message shows
_DEEPEST = 60
_LONGEST_ROW = 1000  # operations; Python's own parser fails at about 3000
_TOO_DEEP = f"is nested more than {_DEEPEST} deep, or has more than {_LONGEST_ROW} operations in a row"
_ONE_LINE = str.maketrans("\n\r\f\t", "    ")
_WORDS: Mapping[type[ast.AST], str] = {
    ast.Lambda: "a function",
    ast.ListComp: "a loop",
    ast.SetComp: "a loop",
    ast.DictComp: "a loop",
    ast.GeneratorExp: "a loop",
    ast.JoinedStr: "a text with braces",
    ast.NamedExpr: "an assignment",
    ast.Slice: "a range",
}


class ExpressionError(RunnerError):
    """Expression that cannot be read or evaluated.

    Args:
        text: The expression.
        index: Position of the error, counted from 0.
        reason: Description of the error.

    Attributes:
        reason: Description of the error.
        position: Position of the error, counted from 1.
    """

    def __init__(self, text: str, index: int, reason: str) -> None:
        self.reason, self.position = reason, index + 1
        first, last = max(0, index - EXCERPT), index + EXCERPT
        before, after = "... " if first else "", " ..." if last < len(text) else ""
        excerpt = before + re.sub(r"\s", " ", text[first:last]) + after
        mark = " " * (len(before) + index - first) + "^"
        super().__init__(f"position {self.position}: {reason}\n    {excerpt}\n    {mark}")


@lru_cache(maxsize=32)  # a long expression takes megabytes
def parse(text: str) -> ast.expr:
    """Return the syntax tree of an expression, with line breaks read as spaces; the tree must not be changed.

    Raises:
        ExpressionError: if the text is not an expression, is too long or is nested too deeply.
    """
    if len(text) > LONGEST:
        raise ExpressionError(text, LONGEST, f"has {len(text)} characters; allowed: up to {LONGEST}")
    text = text.translate(_ONE_LINE)
    if "\0" in text:  # Python has several errors for it
        raise ExpressionError(text, text.index("\0"), "contains a null byte")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Python's warnings about style
            tree = ast.parse(text, mode="eval").body
    except SyntaxError as error:
        early = error.msg == "invalid syntax" and not error.offset
        told = "it ends too early" if early else re.split(r"[.;] ", error.msg)[0]
        raise ExpressionError(text, (error.offset or len(text) + 1) - 1, f"is not an expression: {told}") from None
    except ValueError:  # a lone surrogate
        raise ExpressionError(text, 0, "contains a character that is not allowed") from None
    except (MemoryError, RecursionError):
        raise ExpressionError(text, 0, _TOO_DEEP) from None
    if behind := text.encode()[tree.end_col_offset :].decode().strip(" )"):
        raise ExpressionError(text, text.rindex(behind), "a comment is not allowed in an expression")
    _check(tree, text)
    return tree


def index_of(node: ast.expr, text: str) -> int:
    """Return the index of the first character of a node in an expression; Python's offsets are in bytes of UTF-8."""
    return len(text.encode()[: node.col_offset].decode(errors="ignore"))


def dotted(node: ast.expr) -> str:
    """Return the name of a node, including dots, or an empty string."""
    if isinstance(node, ast.Attribute):
        owner = dotted(node.value)
        return f"{owner}.{node.attr}" if owner else ""
    return node.id if isinstance(node, ast.Name) else ""


def chain(node: ast.expr, *signs: type[ast.operator]) -> tuple[ast.expr, list[ast.BinOp]]:
    """Return the first operand of a chain of operations such as a + b - c, and the operations from left to right.

    Only the given operators count; without any, all count. An expression in brackets starts after its chain and is
    therefore an operand.
    """
    row: list[ast.BinOp] = []
    start = node.col_offset
    while isinstance(node, ast.BinOp) and node.col_offset == start and isinstance(node.op, signs or ast.operator):
        row.append(node)
        node = node.left
    return node, row[::-1]


def _check(tree: ast.expr, text: str) -> None:
    """Check the nesting depth, the length of chains of operations, and for loops, functions and so on."""
    left: list[tuple[ast.AST, int]] = [(tree, 0)]
    while left:
        node, depth = left.pop()
        first, row = chain(node) if isinstance(node, ast.BinOp) else (node, [])
        told = f"{_WORDS[type(node)]} is not allowed in an expression" if type(node) in _WORDS else ""
        if depth > _DEEPEST or len(row) > _LONGEST_ROW:
            told = _TOO_DEEP
        if told:
            raise ExpressionError(text, index_of(node, text) if isinstance(node, ast.expr) else 0, told)
        inner = [first, *(each.right for each in row)] if row else ast.iter_child_nodes(node)
        left += [(each, depth + 1) for each in inner if each._fields]
