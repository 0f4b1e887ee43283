"""Stored axes of a grid, and the overrides of each cell."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from runner.base.errors import StoreError


@dataclass(frozen=True)
class Counted(Sequence[str]):
    """Overrides that count, such as seed=0, seed=1, ..., made when asked for.

    Attributes:
        start: What each begins with, such as "seed=".
        numbers: What follows.
    """

    start: str
    numbers: range

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, place: Any) -> Any:
        found = self.numbers[place]
        return f"{self.start}{found}" if isinstance(found, int) else Counted(self.start, found)

    def __iter__(self) -> Iterator[str]:
        return (f"{self.start}{number}" for number in self.numbers)


class GridOverrides(Sequence[Sequence[str]]):
    """The overrides of each cell of a grid, made when asked for; the last axis changes fastest.

    Args:
        axes: Overrides of each axis; an empty one says only how a run is made, and is none of the cell's.

    Attributes:
        axes: As given.
    """

    def __init__(self, axes: Sequence[Sequence[str]]) -> None:
        self.axes = axes

    def __len__(self) -> int:
        return math.prod(len(axis) for axis in self.axes)

    def __getitem__(self, cell: Any) -> Any:
        if isinstance(cell, slice):
            return [self[each] for each in range(*cell.indices(len(self)))]
        left = range(len(self))[cell]
        texts = []
        for axis in reversed(self.axes):
            left, place = divmod(left, len(axis))
            texts.append(axis[place])
        return tuple(text for text in reversed(texts) if text)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]

    def content(self) -> list[Any]:
        """Return the axes as they are stored; see `read_axes`."""
        return [
            {"start": axis.start, "range": [axis.numbers.start, axis.numbers.stop, axis.numbers.step]}
            if isinstance(axis, Counted)
            else list(axis)
            for axis in self.axes
        ]


def read_axes(content: object) -> GridOverrides:
    """Return stored axes: a list of overrides each, or `start` and `range` (start, stop, step) of one that counts.

    Raises:
        StoreError: if they are none.
    """
    if not isinstance(content, list):
        raise StoreError("its axes are no list")
    return GridOverrides([_read_axis(axis) for axis in content])


def _read_axis(axis: object) -> Sequence[str]:
    if isinstance(axis, list) and all(isinstance(text, str) for text in axis):
        return tuple(axis)
    if isinstance(axis, Mapping) and isinstance(axis.get("start"), str) and isinstance(axis.get("range"), list):
        numbers = axis["range"]
        if len(numbers) == 3 and all(type(number) is int for number in numbers) and numbers[2]:
            return Counted(axis["start"], range(*numbers))
    raise StoreError("an axis is no list of overrides, and none that counts")
