"""Grids of a study: runs from overrides and axes, and arithmetic in overrides; grids.py describes the format."""

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PlainValidator, model_validator

from runner.base.errors import RunnerError, nearest
from runner.base.limits import GRID
from runner.base.sanitize import quoted
from runner.papers.expressions import insertions
from runner.papers.expressions.evaluator import OperationBudget, Scope
from runner.papers.expressions.grammar import ExpressionError
from runner.papers.study.code import UserPlugin
from runner.papers.study.results import Parts
from runner.schema.model import StrictModel

Level = str | int | float
"""Value of a name: a number or a string."""

_LONGEST = 2000  # characters of a string with expressions
_OPERATIONS = 1000
_SLASH = re.compile(r"/(?![^{}]*\}\})")  # between two parts of a name, not within an expression


def fill(text: str, scope: Mapping[str, Level]) -> str:
    """Return a string with its expressions evaluated, numbers with nine digits at most: 1.0 is inserted as "1".

    Args:
        text: The string, such as "robot.mass={{ mass / 2 }}".
        scope: Value of each name.

    Raises:
        RunnerError: if an expression is none, or has no value that can be put in.
    """
    if "{{" not in text:
        return text
    if len(text) > _LONGEST:
        raise RunnerError(f"{quoted(text)}: has {len(text)} characters; allowed: up to {_LONGEST}")
    try:
        return insertions.fill(text, Scope({"round": _rounded}, scope), OperationBudget(_OPERATIONS), _shown)
    except ExpressionError as error:
        raise RunnerError(f"{quoted(text)}: {error.reason}") from None


def alone(text: str) -> str | None:
    """Return the name that an override consists of, as "mass" of "{{ mass }}"; None where there is more to it."""
    match = re.fullmatch(r"\{\{\s*([\w.]+)\s*\}\}", text)
    return match[1] if match else None


def names_in(text: str) -> set[str]:
    """Return the names in the expressions of a string."""
    pieces = [text[start:stop] for start, stop in insertions.insertions(text)]
    return {name for piece in pieces for name in re.findall(r"[A-Za-z_][\w.]*", piece)}


def _rounded(value: float, digits: float | None = None) -> float:
    return round(value) if digits is None else round(float(value), int(digits))  # Python computes 10**digits for an int


def _shown(value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise RunnerError(f"gives {quoted(value)}; only a finite number or a string can be inserted")
    return f"{value:.9g}"


Overrides = tuple[str, ...]


def _levels(value: object) -> Mapping[Level, Overrides | None]:
    """Return the levels of an axis, and what each label stands for; None where it is a list."""
    if not isinstance(value, list | dict) or not value:
        raise ValueError("must be a list of levels, or a group of labels and their overrides")
    if isinstance(value, dict):
        return {label: _stands_for(label, own) for label, own in value.items()}
    for level in value:
        if type(level) not in (str, int, float) or (isinstance(level, float) and not math.isfinite(level)):
            raise ValueError("a level must be a finite number or a text, 'true' in quotes")
    if len(set(value)) < len(value):
        raise ValueError("has a level twice")
    return dict.fromkeys(value)


def _stands_for(label: str, value: object) -> Overrides:
    try:
        return tuple(_flat([value] if isinstance(value, str) else value))
    except ValueError:
        raise ValueError(f"level '{label}' must stand for an override or a list of them") from None


def _flat(value: object) -> list[str]:
    """Return the overrides of a list whose items are overrides or lists of them, as an alias puts in."""
    if not isinstance(value, list):
        raise ValueError("must be a list of overrides")
    overrides = []
    for item in value:
        overrides += [item] if isinstance(item, str) else _flat(item)
    return overrides


FlatOverrides = Annotated[list[str], BeforeValidator(_flat)]
"""A list of overrides, written with lists of them as items, as an alias puts in."""


class StudyGrid(StrictModel):
    """Runs that differ in the levels of axes.

    Attributes:
        name: How the runs' names begin, with axes in double braces; empty stands for the grid's key.
        with_: Overrides that all have.
        over: Levels by axis, and what each label stands for.
        values: Numbers that expressions may name, by name.
        plugins: Config group of an axis that takes user-supplied parts as further levels, by axis.
    """

    name: str = ""
    with_: FlatOverrides = Field(default_factory=list, alias="with")
    over: dict[str, Annotated[Mapping[Level, Overrides | None], PlainValidator(_levels)]] = Field(default_factory=dict)
    values: dict[str, float] = Field(default_factory=dict)
    plugins: dict[str, Literal["controller", "environment", "plant", "trajectory"]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _axes_that_take_plugins(self) -> "StudyGrid":
        for axis in self.plugins:
            if axis not in self.over:
                raise ValueError(f"plugins: there is no axis '{axis}'{nearest(axis, self.over)}")
        return self

    def with_parts(self, parts: Sequence[UserPlugin]) -> Self:
        """Return the grid with user-supplied parts as further levels of the axes of their group.

        Raises:
            RunnerError: if an axis has a level of that name.
        """
        over = {axis: {**levels, **self._added(axis, parts)} for axis, levels in self.over.items()}
        return self.model_copy(update={"over": over})

    def _added(self, axis: str, parts: Sequence[UserPlugin]) -> dict[Level, Overrides | None]:
        levels = self.over[axis]
        own = [part for part in parts if part.group == self.plugins.get(axis)]
        for part in own:
            if part.name in levels:
                raise RunnerError(
                    f"axis '{axis}' has a level '{part.name}', as is --plugin {part.override}; rename yours"
                )
        return {part.name: None if None in levels.values() else (part.override,) for part in own}

    def only(self, axis: str, level: Level) -> Self:
        """Return the grid with one level of an axis."""
        return self.model_copy(update={"over": {**self.over, axis: {level: self.over[axis][level]}}})

    def runs(self, key: str, values: Mapping[str, float]) -> Iterator[tuple[Parts, Overrides]]:
        """Yield the parts of the name and the overrides of each run.

        Args:
            key: The grid's key.
            values: Numbers that expressions of all grids may name.
        """
        items = [*self.with_, *(f"{{{{ {axis} }}}}" for axis in self.over if not self._is_placed(axis))]
        if excess := GRID.excess(math.prod(map(len, self.over.values()))):
            raise RunnerError(excess)
        named = [(alone(text) or "", text) for text in _SLASH.split(self.name or key)]
        rest = [axis for axis in self.over if not any(axis in names_in(text) for _, text in named)]
        for levels in itertools.product(*self.over.values()):
            chosen = dict(zip(self.over, levels, strict=True))
            scope = {**values, **self.values, **chosen}
            begin = ((axis if axis in chosen else "", fill(text, scope)) for axis, text in named)
            overrides = tuple(text for item in items for text in self._expand(item, chosen, scope, ()))
            yield (*begin, *((axis, str(chosen[axis])) for axis in rest)), overrides

    def _is_placed(self, axis: str) -> bool:
        texts = [*self.with_, *(text for levels in self.over.values() for own in levels.values() for text in own or ())]
        if None in self.over[axis].values():
            return any(axis in names_in(text) for text in texts)
        return any(alone(text) == axis for text in texts)

    def _expand(
        self, item: str, chosen: Mapping[str, Level], scope: Mapping[str, Level], within: Sequence[str]
    ) -> Iterator[str]:
        axis = alone(item)
        if axis is None or axis not in chosen:
            yield fill(item, scope)
            return
        if axis in within:
            raise RunnerError(f"axis '{axis}' is put into itself")
        own = self.over[axis][chosen[axis]]
        if own is None:
            yield f"{axis}={chosen[axis]}"
        for text in own or ():
            yield from self._expand(text, chosen, scope, (*within, axis))
