"""One grid of a work: from its overrides and axes to its runs; runner/works/grids.py tells the format."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated

from pydantic import BeforeValidator, Field, PlainValidator

from runner.errors import RunnerError
from runner.registry import StrictModel
from runner.works.arithmetic import Level, alone, fill, names_in

Overrides = tuple[str, ...]
_MOST = 10_000  # runs of a grid


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


class Grid(StrictModel):
    """Runs that differ in the levels of axes.

    Attributes:
        name: How the runs' names begin, with axes in double braces; empty stands for the grid's key.
        with_: Overrides that all have.
        over: Levels by axis, and what each label stands for.
        values: Numbers that expressions may name, by name.
    """

    name: str = ""
    with_: Annotated[list[str], BeforeValidator(_flat)] = Field(default_factory=list, alias="with")
    over: dict[str, Annotated[Mapping[Level, Overrides | None], PlainValidator(_levels)]] = Field(default_factory=dict)
    values: dict[str, float] = Field(default_factory=dict)

    def runs(self, key: str, values: Mapping[str, float]) -> Iterator[tuple[str, Overrides]]:
        """Yield name and overrides of each run.

        Args:
            key: The grid's key.
            values: Numbers that expressions of all grids may name.
        """
        items = [*self.with_, *(f"{{{{ {axis} }}}}" for axis in self.over if not self._is_placed(axis))]
        if (count := math.prod(map(len, self.over.values()))) > _MOST:
            raise RunnerError(f"stands for {count} runs; allowed: up to {_MOST}")
        begin = self.name or key
        rest = [axis for axis in self.over if axis not in names_in(begin)]
        for levels in itertools.product(*self.over.values()):
            chosen = dict(zip(self.over, levels, strict=True))
            scope = {**values, **self.values, **chosen}
            name = "/".join([fill(begin, scope), *(str(chosen[axis]) for axis in rest)])
            yield name, tuple(text for item in items for text in self._expand(item, chosen, scope, ()))

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
