"""Expressions in a chapter, `{{ ... }}`, with their values kept separate from the Markdown.

A placeholder replaces each value before Markdown is parsed. A value can therefore never become markup, a block or
another expression.
"""

import ast
import re
from collections import ChainMap
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from runner.base.errors import RunnerError
from runner.papers.expressions.evaluator import OperationBudget, Scope
from runner.papers.expressions.grammar import ExpressionError, parse
from runner.papers.expressions.insertions import insertions
from runner.papers.reporting.claims import Claim
from runner.papers.study.measured import Condition, Measured
from runner.papers.study.prose.signals import Quantity
from runner.papers.study.prose.tables import RunColumn
from runner.papers.study.results import MissingError
from runner.reporting.document import Panel, ReportBlock, Section, Series
from runner.reporting.table import Number

OPEN, CLOSE = "\uf000", "\uf001"
"""Characters around the number of a value that is stored separately."""
PLACEHOLDER = re.compile(f"{OPEN}(\\d+){CLOSE}")

PRIVATE = re.compile("[\ue000-\uf8ff]")
_STATEMENT = re.compile(r"\{%|%\}|\{#")
_SET = re.compile(r"^\{% set (\w+) = (.*?) %\}$", re.MULTILINE | re.DOTALL)
_BRANCHES = (ast.IfExp, ast.BoolOp, ast.Not)
_MEMBERS = {Measured: ("value", "shown", "near", "with_other"), Condition: ("holds",), Quantity: ()}
_HANDED = (ReportBlock, Section, RunColumn, Number, Panel, Series, Claim, np.ndarray)


class ChapterValues:
    """The values of a chapter's expressions, each with its line.

    Args:
        file: Name of the chapter's file.
        names: What expressions may call and read, by name.
        handed: Further classes whose values they hand on as they are.
        read: Names of the results that expressions have read; the results add to it.
    """

    def __init__(
        self, file: str, names: Mapping[str, Any], handed: tuple[type, ...] = (), read: set[str] | None = None
    ) -> None:
        functions = {name: value for name, value in names.items() if callable(value)}
        self.named: dict[str, Any] = {}
        """The values that the chapter itself gives a name, by that."""
        given = {name: value for name, value in names.items() if name not in functions}
        self._scope = Scope(functions, ChainMap(self.named, given), _MEMBERS, (*_HANDED, *handed))
        self._file, self._budget = file, OperationBudget()
        self._read = set() if read is None else read
        self._read_by: dict[str, frozenset[str]] = {}
        self.found: list[tuple[Any, int]] = []
        self._lines = [1]

    def put_away(self, text: str) -> str:
        """Return a chapter with a placeholder for each of its expressions; `line_of` returns their lines.

        Raises:
            ProseError: if one cannot be evaluated, or there is a branch, a loop or a private character.
        """
        for number, content in enumerate(text.splitlines(), start=1):
            if PRIVATE.search(content):
                raise ProseError(self._file, number, "has a character for private use; leave it out")
        self.name_values(text)
        text = _SET.sub(lambda found: "\n" * found[0].count("\n"), text)
        parts: list[str] = []
        end, line = 0, 1
        try:
            for start, stop in insertions(text):
                line = self._keep(text[end:start], line, parts)
                parts.append(self.put(self.value(text[start + 2 : stop - 2], line), line))
                line += text.count("\n", start, stop)
                end = stop
        except ExpressionError as error:
            raise ProseError(self._file, text.count("\n", 0, error.position) + 1, error.reason) from None
        self._keep(text[end:], line, parts)
        rest = "".join(parts)
        if found := _STATEMENT.search(rest):
            line = self.line_of(rest.count("\n", 0, found.start()) + 1)
            raise ProseError(self._file, line, f"{found[0]} is not used here: a chapter has one branch and no loops")
        return rest

    def name_values(self, text: str, needed: Collection[str] | None = None) -> None:
        """Give names to the values of `{% set name = EXPRESSION %}` of a chapter.

        Args:
            text: The chapter.
            needed: The names to give; None for all.

        Raises:
            ProseError: if an expression cannot be evaluated, or a name is given twice.
        """
        for found in _SET.finditer(text):
            line = text.count("\n", 0, found.start()) + 1
            if found[1] in self.named:
                raise ProseError(self._file, line, f"set {found[1]}: the name is taken above; choose another")
            if needed is None or found[1] in needed:
                self.named[found[1]] = self.value(found[2], line)
                self._read_by[found[1]] = self.read_by(found[2])

    def read_by(self, expression: str) -> frozenset[str]:
        """Return the names of the results that an evaluated expression has read, also by the names in it."""
        return self._read_by.get(" ".join(expression.split()), frozenset())

    def line_of(self, number: int) -> int:
        """Return the line of the file that became a line of the text without expressions; both count from 1."""
        return self._lines[min(number, len(self._lines)) - 1]

    def _keep(self, piece: str, line: int, parts: list[str]) -> int:
        """Add a piece without expressions that begins on a line; return the line on which it ends."""
        parts.append(piece)
        for _ in range(piece.count("\n")):
            line += 1
            self._lines.append(line)
        return line

    def put(self, value: Any, line: int) -> str:
        """Keep a value and return its placeholder."""
        self.found.append((value, line))
        return f"{OPEN}{len(self.found) - 1}{CLOSE}"

    def value(self, expression: str, line: int, instead: Mapping[str, Any] | None = None) -> Any:
        """Return the value of an expression.

        Operations count towards the limit of the file, those with replaced values for each expression anew.

        Args:
            expression: The expression.
            line: Its line, counted from 1.
            instead: Values that replace those of some names.

        Raises:
            ProseError: if it has none; names the place.
        """
        source = " ".join(expression.split())
        scope = replace(self._scope, values={**self._scope.values, **instead}) if instead else self._scope
        try:
            if any(isinstance(node, _BRANCHES) for node in ast.walk(parse(source))):
                told = "chooses between words; a chapter has one branch: state a condition in a finding"
                raise ProseError(self._file, line, f"{source}: {told}")
            others = self._read.copy()
            self._read.clear()
            value = scope.evaluate(source, OperationBudget() if instead else self._budget)
            self._read_by[source] = frozenset(self._read).union(*map(self.read_by, names_in(source)))
            self._read |= others
            return value
        except (ProseError, MissingError):  # what a run that was not made is needed for is left out of the report
            raise
        except RunnerError as error:
            told = error.reason if isinstance(error, ExpressionError) else str(error)
            raise ProseError(self._file, line, f"{source}: {told}") from error


def names_in(expression: str) -> set[str]:
    """Return the names in an expression."""
    return {node.id for node in ast.walk(parse(" ".join(expression.split()))) if isinstance(node, ast.Name)}


def needed_names(text: str, expressions: Iterable[str]) -> set[str]:
    """Return the names that a chapter gives and that expressions need, directly or by another one."""
    given = {found[1]: found[2] for found in _SET.finditer(text)}
    needed, left = set[str](), list(expressions)
    while left:
        new = names_in(left.pop()) & given.keys() - needed
        needed |= new
        left += [given[name] for name in new]
    return needed


class ProseError(RunnerError):
    """A chapter that cannot be read.

    Args:
        file: Its name.
        line: The line, counted from 1.
        text: What is wrong, and what to write in its place.
    """

    def __init__(self, file: str, line: int, text: str) -> None:
        super().__init__(f"{file}:{line}: {text}")
        self.line = line
