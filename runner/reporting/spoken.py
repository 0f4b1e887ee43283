"""Spoken form of Typst mathematics for screen readers."""

import re
from collections.abc import Sequence

_TOKEN = re.compile(r'"[^"]*"|[A-Za-z]+(?:\.[a-z]+)*|\d+(?:\.\d+)?|->|=>|<=|>=|!=|\.\.\.|\S')
_WORDS = {
    "=": "equals", "+": "plus", "-": "minus", "<": "is less than", ">": "is greater than", "<=": "is at most",
    ">=": "is at least", "!=": "is not", "->": "goes to", "=>": "so that", "...": "and so on", "slash": "over",
    "/": "over", "times": "times", "dot.c": "times", "dot.op": "times", "*": "times", "approx": "is about",
    "infinity": "infinity", "in": "in", "plus.minus": "plus or minus", "quad": ",", "sum": "the sum of",
    "integral": "the integral of", "tilde": "about", ";": ";", ",": ",",
}  # fmt: skip
_BEFORE = {
    "differs": "marked",
    "sqrt": "the root of",
    "abs": "the size of",
    "norm": "the length of",
    "vec": "the vector",
    "mat": "the matrix",
}
_BEHIND = {
    "dot": "dot",
    "dot.double": "double dot",
    "hat": "hat",
    "tilde": "tilde",
    "overline": "bar",
    "arrow": "arrow",
}
_PLAIN = {"upright", "bold", "italic", "op", "text", "cal", "lr", "display", "inline"}
_POWERS = {"2": "squared", "3": "cubed", "T": "transposed", "minus 1": "inverse"}
_LEFT, _RIGHT = "([{", ")]}"


def spoken(typst: str) -> str:
    """Return a formula in words, such as "omega n squared equals k p"."""
    words = _Reader(_TOKEN.findall(typst)).sequence()
    return re.sub(r"\s+([,;])", r"\1", " ".join(words.split())).strip(" ,;")


class _Reader:
    """Reads a formula from left to right.

    Args:
        tokens: Its words, numbers and signs.
    """

    def __init__(self, tokens: Sequence[str]) -> None:
        self._tokens, self._place = tokens, 0

    def sequence(self, end: str = "") -> str:
        """Return what stands up to a closing sign, or the end, in words."""
        told: list[str] = []
        while self._place < len(self._tokens) and self._tokens[self._place] not in end:
            told.append(self._with_scripts(self._atom(), end))
        self._place += bool(end)
        return " ".join(told)

    def _with_scripts(self, base: str, end: str) -> str:
        while self._next() in ("_", "^", "'") and self._next() not in end:
            sign = self._take()
            if sign == "'":
                base = f"{base} prime"
                continue
            script = self._group()
            base = f"{base} {script if sign == '_' else _POWERS.get(script, f'to the power of {script}')}"
        return base

    def _group(self) -> str:
        """Return the next script: what stands in parentheses, or one word."""
        if self._next() == "(":
            self._take()
            return self.sequence(")")
        return self._atom()

    def _atom(self) -> str:
        word = self._take()
        if word.startswith('"'):
            return word.strip('"')
        if self._next() == "(" and (word in _BEFORE or word in _BEHIND or word in _PLAIN):
            self._take()
            inside = self.sequence(")")
            if word in _BEHIND:
                return f"{inside} {_BEHIND[word]}"
            return f"{_BEFORE.get(word, '')} {inside}"
        if self._next() == "(" and word == "frac":
            self._take()
            return self.sequence(")").replace(",", " over", 1)
        if word == "|":
            return f"the size of {self.sequence('|')}"
        if word in _LEFT:
            return self.sequence(_RIGHT[_LEFT.index(word)])
        return _WORDS.get(word, word.replace(".", " "))

    def _next(self) -> str:
        return self._tokens[self._place] if self._place < len(self._tokens) else ""

    def _take(self) -> str:
        token = self._next()
        self._place += 1
        return token
