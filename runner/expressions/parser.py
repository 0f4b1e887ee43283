"""Arithmetic as people print it, read safely: never evaluated as code, every refusal with its position.

Grammar, from loosest to tightest binding:

    sum     = ("+" | "-")? product (("+" | "-") product)*
    product = factor (("*" | "/") factor)*
    factor  = ("+" | "-") factor | power
    power   = atom (("^" | "**") factor)?
    atom    = number | name | function "(" sum ("," sum)* ")" | "(" sum ")"

A power binds tighter than the sign before it, so that `-s1^2` is `-(s1^2)`, and is grouped from the right. A name is
a letter followed by letters, digits and underscores, and primes (`s2'`); what it stands for is up to the evaluation.
A product always has its sign: `2 s1` and `c1(q2)` are refused, since a lost sign and a lost bracket look alike.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

from runner.errors import RunnerError, nearest
from runner.expressions.tree import Call, Name, Node, Number, Power, Product, Sum

FUNCTIONS = {
    **dict.fromkeys(("sin", "cos", "tan", "asin", "acos", "atan", "arcsin", "arccos", "arctan", "sqrt", "abs"), 1),
    "atan2": 2,
}
"""The functions that an expression may call, with their number of arguments."""

_DEEPEST = 60
_LONGEST = 100_000
_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([^\W\d]\w*'*)|(\*\*|[-+*/^(),])|(\S))")
_EXCERPT = 30


class ExpressionError(RunnerError):
    """An expression that cannot be read or evaluated.

    Attributes:
        reason: What is wrong.
        position: Where, counted from 1.
    """

    def __init__(self, text: str, index: int, reason: str) -> None:
        self.reason, self.position = reason, index + 1
        first, last = max(0, index - _EXCERPT), index + _EXCERPT
        before, after = "... " if first else "", " ..." if last < len(text) else ""
        excerpt = before + re.sub(r"\s", " ", text[first:last]) + after
        mark = " " * (len(before) + index - first) + "^"
        super().__init__(f"position {self.position}: {reason}\n    {excerpt}\n    {mark}")


@dataclass(frozen=True)
class Expression:
    """An expression as read.

    Attributes:
        text: As it is written.
        root: Its structure.
    """

    text: str
    root: Node


def parse(text: str) -> Expression:
    """Read an expression.

    Raises:
        ExpressionError: With the position of what cannot be read.
    """
    return Expression(text, _Reader(text).read())


class _Reader:
    """The parser: one method for each line of the grammar; `_next` is the word or sign that stands next."""

    def __init__(self, text: str) -> None:
        self._text, self._place, self._depth = text, 0, 0
        if len(text) > _LONGEST:
            self._refuse(_LONGEST, f"the expression has {len(text)} characters; at most {_LONGEST} are read")
        self._advance()

    def read(self) -> Node:
        if not self._next:
            self._refuse(self._index, "the expression is empty")
        root = self._sum()
        if self._next == ")":
            self._refuse(self._index, "this ')' has no '(' before it")
        if self._next:
            self._refuse(self._index, self._unexpected())
        return root

    def _sum(self) -> Node:
        index = self._index
        negative = self._next in ("+", "-") and self._take() == "-"
        terms = [(negative, self._product())]
        while self._next in ("+", "-"):
            minus = self._take() == "-"
            terms.append((minus, self._product()))
        return Sum(tuple(terms), index) if negative or len(terms) > 1 else terms[0][1]

    def _product(self) -> Node:
        index, factors = self._index, [(False, self._factor())]
        while self._next in ("*", "/"):
            over = self._take() == "/"
            factors.append((over, self._factor()))
        return factors[0][1] if len(factors) == 1 else Product(tuple(factors), index)

    def _factor(self) -> Node:
        index = self._index
        if self._next not in ("+", "-"):
            return self._power()
        minus = self._take() == "-"
        with_sign = self._deeper(self._factor)
        return Sum(((True, with_sign),), index) if minus else with_sign

    def _power(self) -> Node:
        base, index = self._atom(), self._index
        if self._next not in ("^", "**"):
            return base
        self._take()
        return Power(base, self._deeper(self._factor), index)

    def _atom(self) -> Node:
        index, kind, word = self._index, self._kind, self._next
        if kind == "number":
            if float(word) == float("inf"):
                self._refuse(index, f"the number {word} is too large")
            self._take()
            return Number(word, index)
        if kind == "name":
            self._take()
            return self._call(word, index) if self._next == "(" else Name(word, index)
        if word == "(":
            return self._bracket(index)
        if not word:
            self._refuse(index, "the expression ends where a number, a name or a '(' should follow")
        if word == ")":
            self._refuse(index, "a number, a name or a '(' should stand before this ')'")
        return self._refuse(index, self._unexpected())

    def _call(self, function: str, index: int) -> Node:
        if function not in FUNCTIONS:
            listed = ", ".join(FUNCTIONS)
            self._refuse(
                index,
                f"'{function}' is no function that can be called{nearest(function, FUNCTIONS)}; functions: {listed}; "
                "a product needs its '*'",
            )
        opening = self._index
        self._take()
        arguments = [self._deeper(self._sum)]
        while self._next == ",":
            self._take()
            arguments.append(self._deeper(self._sum))
        self._close(opening)
        if len(arguments) != FUNCTIONS[function]:
            self._refuse(index, f"{function} takes {FUNCTIONS[function]} argument(s), not {len(arguments)}")
        return Call(function, tuple(arguments), index)

    def _bracket(self, index: int) -> Node:
        self._take()
        inner = self._deeper(self._sum)
        self._close(index)
        return inner

    def _close(self, opening: int) -> None:
        if not self._next:
            self._refuse(opening, "this '(' is never closed")
        if self._next != ")":
            self._refuse(self._index, self._unexpected())
        self._take()

    def _deeper(self, read: Callable[[], Node]) -> Node:
        self._depth += 1
        if self._depth > _DEEPEST:
            self._refuse(self._index, f"brackets, signs or powers nested more than {_DEEPEST} deep")
        node = read()
        self._depth -= 1
        return node

    def _take(self) -> str:
        taken = self._next
        self._advance()
        return taken

    def _advance(self) -> None:
        match = _TOKEN.match(self._text, self._place)
        if match is None or match.lastindex is None:
            self._kind, self._next, self._index = "end", "", len(self._text)
            return
        self._kind = ("", "number", "name", "sign", "other")[match.lastindex]
        self._next, self._index, self._place = match[match.lastindex], match.start(match.lastindex), match.end()

    def _unexpected(self) -> str:
        if self._next == "…":
            return "the text is lost here"
        if self._next == ".":
            return "attribute access is no arithmetic: a '.' stands in decimal numbers alone"
        if self._kind in ("number", "name") or self._next == "(":
            return f"'{self._next}' follows without a sign; a product needs its '*'"
        if self._kind == "sign":
            return f"'{self._next}' cannot stand here"
        return f"'{self._next}' is no sign of arithmetic; signs: + - * / ^ ** ( ) ,"

    def _refuse(self, index: int, reason: str) -> NoReturn:
        raise ExpressionError(self._text, index, reason)
