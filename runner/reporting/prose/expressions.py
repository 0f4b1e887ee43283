"""Expressions in a chapter, `{{ ... }}`: evaluated in a sandbox, their values kept apart from the Markdown around them.

Each value gives way to a placeholder before Markdown is read, so that nothing it holds can become markup, a block or
another expression.
"""

import re
import traceback
from collections.abc import Callable, Mapping
from typing import Any

import jinja2
from jinja2 import nodes
from jinja2.exceptions import SecurityError
from jinja2.sandbox import ImmutableSandboxedEnvironment

from runner.errors import RunnerError, nearest
from runner.reporting.job import MissingError
from runner.reporting.prose.problem import ProseError

OPEN, CLOSE = "\uf000", "\uf001"
"""Characters around the number of a value that stands elsewhere."""
PLACEHOLDER = re.compile(f"{OPEN}(\\d+){CLOSE}")

PRIVATE = re.compile("[\ue000-\uf8ff]")
_STATEMENT = re.compile(r"\{%|%\}|\{#")
_SET = re.compile(r"^\{% set (\w+) = (.*?) %\}$", re.MULTILINE | re.DOTALL)
_BRANCHES = (nodes.CondExpr, nodes.And, nodes.Or, nodes.Not)
_LONGEST = 10_000  # of a text or list that an expression makes


class _Sandbox(ImmutableSandboxedEnvironment):
    """A sandbox in which no expression makes something huge."""

    intercepted_binops = frozenset(["*", "**"])

    def call_binop(self, context: jinja2.runtime.Context, operator: str, left: Any, right: Any) -> Any:
        if operator == "**" or any(isinstance(side, str | list | tuple) for side in (left, right)):
            raise SecurityError(f"{operator} of {type(left).__name__} and {type(right).__name__} is not allowed here")
        return super().call_binop(context, operator, left, right)


class Values:
    """The values of a chapter's expressions, each with the line that it stands on.

    Args:
        file: Name of the chapter's file.
        names: What expressions may call and read, by name.
    """

    def __init__(self, file: str, names: Mapping[str, Any]) -> None:
        self._file, self._names = file, dict(names)
        self._set: list[str] = []
        self.found: list[tuple[Any, int]] = []
        self._lines = [1]
        self._compiled: dict[str, Callable[..., Any]] = {}  # by expression
        self._environment = _Sandbox(undefined=jinja2.StrictUndefined, autoescape=False)
        self._environment.filters = {}
        self._environment.tests = {}
        self._environment.globals = {}

    def put_away(self, text: str) -> str:
        """Return a chapter with a placeholder for each of its expressions; `line_of` tells where its lines were.

        Raises:
            ProseError: if one cannot be evaluated, or there is a branch, a loop or a private character.
        """
        for number, content in enumerate(text.splitlines(), start=1):
            if PRIVATE.search(content):
                raise ProseError(self._file, number, "has a character for private use; leave it out")
        text = self._without_names(text)
        parts: list[str] = []
        end, line = 0, 1
        for start, stop in _braces(text, self._file):
            line = self._keep(text[end:start], line, parts)
            parts.append(self.put(self.value(text[start + 2 : stop - 2], line), line))
            line += text.count("\n", start, stop)
            end = stop
        self._keep(text[end:], line, parts)
        rest = "".join(parts)
        if found := _STATEMENT.search(rest):
            line = self.line_of(rest.count("\n", 0, found.start()) + 1)
            raise ProseError(self._file, line, f"{found[0]} is not used here: a chapter has one branch and no loops")
        return rest

    def _without_names(self, text: str) -> str:
        """Give names to the values of `{% set name = EXPRESSION %}`; return the text with these left empty."""
        for found in _SET.finditer(text):
            line = text.count("\n", 0, found.start()) + 1
            if found[1] in self._set:
                raise ProseError(self._file, line, f"set {found[1]}: the name is taken above; choose another")
            self._names[found[1]] = self.value(found[2], line)
            self._set.append(found[1])
        return _SET.sub(lambda found: "\n" * found[0].count("\n"), text)

    def line_of(self, number: int) -> int:
        """Return on which line of the file a line of the text without expressions stands; both count from 1."""
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

    @property
    def named(self) -> dict[str, Any]:
        """The values that the chapter itself gives a name, by that."""
        return {name: self._names[name] for name in self._set}

    def value(self, expression: str, line: int, instead: Mapping[str, Any] | None = None) -> Any:
        """Return the value of an expression.

        Args:
            expression: The expression.
            line: Where it stands.
            instead: Values that some names have in place of their own.

        Raises:
            ProseError: if it has none; names the place.
        """
        source = " ".join(expression.split())
        try:
            if source not in self._compiled:
                self._compiled[source] = self._compile(source, line)
            value = self._compiled[source](**self._names | dict(instead or {}))
            if isinstance(value, jinja2.Undefined):
                str(value)  # raises, and says what is not there
            return value
        except (ProseError, MissingError):  # what a run that was not made is needed for is left out of the report
            raise
        except RunnerError as error:
            raise ProseError(self._file, line, f"{source}: {error}") from error
        except jinja2.UndefinedError as error:
            name = re.sub(r"^'(\w+)' is undefined$", r"\1", str(error))
            told = f"no name '{name}'{nearest(name, self._names)}" if name.isidentifier() else str(error)
            raise ProseError(self._file, line, f"{source}: {told}") from error
        except jinja2.TemplateSyntaxError as error:
            raise ProseError(self._file, line, f"{source}: is no expression: {error.message}") from error
        except Exception as error:
            told = traceback.format_exception_only(error)[-1].strip()
            raise ProseError(self._file, line, f"{source}: {told}") from error

    def _compile(self, source: str, line: int) -> Callable[..., Any]:
        """Return a function of the names that gives the value of an expression."""
        tree = self._environment.parse("{{ " + source + " }}")
        for node in tree.find_all((*_BRANCHES, nodes.Filter, nodes.Test)):
            raise ProseError(self._file, line, f"{source}: {_refused(node)}")
        return self._environment.compile_expression(source, undefined_to_none=False)


def _refused(node: nodes.Node) -> str:
    if isinstance(node, _BRANCHES):
        return "chooses between words; a chapter has one branch: state a condition in a finding"
    return "filters and tests are not used here; call a function"


def _braces(text: str, file: str) -> list[tuple[int, int]]:
    """Return begin and end of each expression in a text, braces included."""
    found, place = [], 0
    while (start := text.find("{{", place)) >= 0:
        stop = text.find("}}", start)
        if stop < 0:
            raise ProseError(file, text.count("\n", 0, start) + 1, "{{ is not closed; write }} behind the expression")
        found.append((start, stop + 2))
        place = stop + 2
    return found
