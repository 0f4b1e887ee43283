"""A mutant: one piece of a module's source replaced by another."""

import ast
import hashlib
from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """An error put into a module.

    Attributes:
        path: Path of the module, from the root of the checkout.
        start, end: Range of bytes of its source that is replaced.
        new: Text in its place.
        unit: Source of the enclosing function; outside of functions, of the statement.
        ordinal: Number among the unit's mutants.
        owner: Dotted name of the function; "" at import.
        block: Ordinal of the block among the owner's; None at import.
        name: Name that the statement assigns at import.
        why: What is wrong then, of a mutant written by hand.
        test: Test file that has to find it; None: those that the coverage map gives.
    """

    path: str
    start: int
    end: int
    new: str
    unit: str
    ordinal: int
    owner: str = ""
    block: int | None = None
    name: str | None = None
    why: str = ""
    test: str | None = None

    @property
    def identity(self) -> str:
        """Digest that stays the same while the path and the source of the unit do."""
        return hashlib.sha256("\0".join([self.path, self.unit, str(self.ordinal), self.new]).encode()).hexdigest()[:16]

    def apply(self, source: str) -> str:
        """Return the module's source with the error."""
        text = source.encode()
        return (text[: self.start] + self.new.encode() + text[self.end :]).decode()

    def line(self, source: str) -> int:
        """Return the number of the line where the error is."""
        return source.encode()[: self.start].count(b"\n") + 1

    def change(self, source: str) -> tuple[str, str]:
        """Return the lines that change, before and after."""
        text = source.encode()
        begin, behind = text.rfind(b"\n", 0, self.start) + 1, text.find(b"\n", self.end)
        head, tail = text[begin : self.start], text[self.end : behind if behind >= 0 else len(text)]
        return (head + text[self.start : self.end] + tail).decode(), (head + self.new.encode() + tail).decode()

    def changes(self, source: str) -> bool:
        """Return True if the error gives another module that Python can read."""
        try:
            compile(wrong := self.apply(source), self.path, "exec", dont_inherit=True)
        except SyntaxError:
            return False
        return ast.dump(ast.parse(wrong)) != ast.dump(ast.parse(source))
