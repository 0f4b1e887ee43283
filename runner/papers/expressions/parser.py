"""Parser of printed arithmetic into an expression tree.

The evaluator's grammar reads the arithmetic. The tree is for evaluation, drawing and comparison. `*` and `@` are the
product of numbers, matrices and vectors. `[[A, b], [0, 1]]` is a matrix of blocks, row by row; `[a, b, c]` is a column.
`Z[i-1]` is one of several quantities, `sum(i, 1, 3, m[i]*Z[i])` a sum, and `a = b = c` an equation of several sides.

A power is written `^` or `**`, and a name can end in primes (`s2'`). The evaluation defines the meaning of a primed
name. Every product needs its sign: the parser rejects `2 s1` and `c1(q2)`, because a lost sign and a lost bracket look
alike.
"""

import ast
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NoReturn

from runner.base.errors import nearest
from runner.papers.expressions import grammar
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.expressions.tree import Call, Name, Node, Power, Product, Sum, WrittenNumber

FUNCTIONS = {
    **dict.fromkeys(("sin", "cos", "tan", "asin", "acos", "atan", "arcsin", "arccos", "arctan", "sqrt", "abs"), 1),
    "atan2": 2,
    **{"transpose": 1, "inverse": 1, "cross": 2, "skew": 1, "log": 1, "sum": 4},
    **{f"{kind}_{axis}": 1 for kind in ("R", "Rot", "Tra") for axis in "xyz"},
}
"""Functions that an expression can call, with their numbers of arguments.

`R_x(a)` turns by an angle about an axis, `skew(v)` is the matrix of the cross product, `log(R)` the rotation vector.
`Rot_x(a)` and `Tra_x(l)` are turns and shifts, 4 by 4.
"""

_FACTORS = (ast.Mult, ast.Div, ast.MatMult)

PRIME = "\N{MODIFIER LETTER PRIME}"
"""Prime character that Python accepts as a letter."""
_TO_PYTHON = {"^": "**", "'": PRIME, "=": "=="}
_FAULT = re.compile(r"(?P<lost>…|\.{3})|(?<=[\w')\]])\s+(?P<apart>\w+)|(?P<sign>[^\w\s'.+\-*/@^=(),\[\]]|(?<![\w'])')")
_TOLD = {
    "lost": "the text is lost here",
    "apart": "'{}' follows without a sign; a product needs its '*'",
    "sign": "'{}' is not a sign of arithmetic; signs: + - * / @ ^ ** = ( ) [ ] ,",
}
_NUMBER = re.compile(r"(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?(?![\w.])")
_PLACE = re.compile(r"[A-Za-z]|\d|[A-Za-z][+-]\d")


@dataclass(frozen=True)
class ParsedExpression:
    """Parsed expression.

    Attributes:
        text: The expression as written.
        root: Root of the expression tree.
    """

    text: str
    root: Node


@lru_cache(maxsize=512)
def parse(text: str) -> ParsedExpression:
    """Return the parsed expression.

    Raises:
        ExpressionError: if it cannot be parsed; the message contains the position.
    """
    if fault := _FAULT.search(text):
        kind = fault.lastgroup or ""
        raise ExpressionError(text, fault.start(kind), _TOLD[kind].format(fault[kind]))
    start = len(text) - len(text.lstrip())
    letters = [" " if each.isspace() else _TO_PYTHON.get(each, each) for each in text[start:]]
    python = "".join(letters).rstrip()
    places = [start + index for index, each in enumerate(letters) for _ in each.encode()] + [len(text)]
    try:
        return ParsedExpression(text, _Reader(python, places).equation(grammar.parse(python)))
    except ExpressionError as error:
        place = places[len(python[: error.position - 1].encode())]
        raise ExpressionError(text, place, error.reason) from None


class _Reader:
    """Conversion of Python's syntax tree, which has no brackets: a bracketed node starts right after a bracket.

    Args:
        python: The expression in Python's syntax.
        places: Position in the original text of each byte.
    """

    def __init__(self, python: str, places: Sequence[int]) -> None:
        self._python, self._bytes, self._places = python, python.encode(), places
        self._inside = {match.end() for match in re.finditer(rb"\( *", self._bytes)}

    def equation(self, node: ast.expr) -> Node:
        """Return an expression, or the sides of an equation."""
        if not (isinstance(node, ast.Compare) and all(isinstance(each, ast.Eq) for each in node.ops)):
            return self.sum(node)
        return Call("=", tuple(map(self.sum, (node.left, *node.comparators))), self._places[node.col_offset])

    def sum(self, node: ast.expr) -> Node:
        """Return a whole expression, a bracket or an argument; a sign before the first factor applies to the term."""
        first, row = grammar.chain(node, ast.Add, ast.Sub)
        factor, _ = grammar.chain(first, *_FACTORS)
        sign = factor.op if isinstance(factor, ast.UnaryOp) and factor.col_offset == node.col_offset else None
        negative = isinstance(sign, ast.USub)
        bracketed = first.col_offset != node.col_offset
        terms = [(negative, self.sum(first) if bracketed else self._product(first, sign is not None))]
        for each in row:
            bracketed = each.right.col_offset in self._inside
            terms.append((isinstance(each.op, ast.Sub), (self.sum if bracketed else self._product)(each.right)))
        return Sum(tuple(terms), self._places[node.col_offset]) if negative or row else terms[0][1]

    def _product(self, node: ast.expr, signed: bool = False) -> Node:
        first, row = grammar.chain(node, *_FACTORS)
        start = node.col_offset
        if signed and isinstance(first, ast.UnaryOp):
            start, first = self._behind(rb"[+-] *", start), first.operand
        factors = [(False, self._factor(first))]
        factors += [(isinstance(each.op, ast.Div), self._factor(each.right)) for each in row]
        return Product(tuple(factors), self._places[start]) if row else factors[0][1]

    def _factor(self, node: ast.expr) -> Node:
        index = self._places[node.col_offset]
        match node:
            case ast.UnaryOp(op=ast.USub()):
                return Sum(((True, self._factor(node.operand)),), index)
            case ast.UnaryOp(op=ast.UAdd()):
                return self._factor(node.operand)
            case ast.BinOp(op=ast.Pow()):
                sign = self._places[self._behind(rb"[) ]*", node.left.end_col_offset or 0)]
                return Power(self._factor(node.left), self._factor(node.right), sign)
            case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div() | ast.MatMult()):
                return self.sum(node)
            case ast.Call(func=ast.Name(id=function), keywords=[]):
                return self._call(node, function, index)
            case ast.Name() if node.id not in FUNCTIONS:
                return Name(node.id.replace(PRIME, "'"), index)
            case ast.Subscript(value=ast.Name(id=name)) if name not in FUNCTIONS:
                places = [ast.unparse(each).replace(" ", "") for each in _items(node.slice)]
                if not all(map(_PLACE.fullmatch, places)):
                    self._refuse(node, "the places of a quantity are letters, digits, or as i+1 and i-1")
                return Name(name.replace(PRIME, "'") + f"[{','.join(places)}]", index)
            case ast.List(elts=[_, *_] as cells):
                rows = [each.elts for each in cells if isinstance(each, ast.List)]
                whole = len(rows) == len(cells)
                return Call(
                    "matrix", tuple(map(self._row, cells, rows if whole else [[each] for each in cells])), index
                )
            case ast.Constant() if number := _NUMBER.match(self._python, grammar.index_of(node, self._python)):
                if float(number[0]) == float("inf"):
                    self._refuse(node, f"the number {number[0]} is too large")
                return WrittenNumber(number[0], index)
        return self._refuse(
            node, "is not arithmetic: numbers, names, + - * / @ ^ ( ) [ ] and functions with their arguments"
        )

    def _row(self, node: ast.expr, cells: Sequence[ast.expr]) -> Node:
        if not cells:
            self._refuse(node, "a row of a matrix needs an element")
        return Call("row", tuple(map(self.sum, cells)), self._places[node.col_offset])

    def _call(self, node: ast.Call, function: str, index: int) -> Node:
        if function not in FUNCTIONS:
            told = f"'{function}' is not a function that can be called{nearest(function, FUNCTIONS)}"
            self._refuse(node, f"{told}; functions: {', '.join(FUNCTIONS)}; a product needs its '*'")
        if len(node.args) != FUNCTIONS[function]:
            self._refuse(node, f"{function} takes {FUNCTIONS[function]} argument(s), not {len(node.args)}")
        arguments = tuple(map(self.sum, node.args))
        if function == "sum" and not _is_sum(arguments):
            self._refuse(node, "a sum is sum(i, 1, 3, ...): a letter, its first and its last number, and what is added")
        return Call(function, arguments, index)

    def _behind(self, pattern: bytes, start: int) -> int:
        match = re.compile(pattern).match(self._bytes, start)
        return match.end() if match else start

    def _refuse(self, node: ast.expr, reason: str) -> NoReturn:
        raise ExpressionError(self._python, grammar.index_of(node, self._python), reason)


def _items(node: ast.expr) -> list[ast.expr]:
    return node.elts if isinstance(node, ast.Tuple) else [node]


def _is_sum(arguments: Sequence[Node]) -> bool:
    letter, *ends = arguments[:3]
    whole = all(isinstance(end, WrittenNumber) and end.text.isdecimal() for end in ends)
    return whole and isinstance(letter, Name) and len(letter.name) == 1
