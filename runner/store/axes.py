"""Axes of a sweep: keys with their typed values, and the overrides of each cell."""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from runner.base.dotted_keys import split_override
from runner.base.errors import StoreError

_PLAIN = re.compile(r"[\w./+-]+|\$\{[\w.]+\}")
_OTHER_KIND = re.compile(r"(?i)null|true|false|[+-]?(inf|nan|[\d._]+(e[+-]?[\d_]+)?)")
_LISTED_UP_TO = 1000  # values of a range; a short range and the same numbers in a list are then the same sweep


@dataclass(frozen=True)
class SweepAxis:
    """A swept key.

    Attributes:
        key: The key as an override begins, such as "noise.position" or "+robot.note".
        values: Values of the key: numbers in SI units, strings, lists and so on. A range of integers is not expanded.
    """

    key: str
    values: Sequence[Any]

    def text(self, number: int) -> str:
        """Return the override for the value with a given index."""
        return f"{self.key}={override_value(self.values[number])}"

    @property
    def typed(self) -> str:
        """The override with all values, as on the command line of a sweep."""
        if isinstance(self.values, range):
            ends = [self.values.start, self.values.stop, *([] if self.values.step == 1 else [self.values.step])]
            return f"{self.key}=range({','.join(map(str, ends))})"
        return f"{self.key}={','.join(map(override_value, self.values))}"


class Axes(Sequence[tuple[str, ...]]):
    """The overrides of each cell of a grid, created on access; the last axis changes fastest.

    Args:
        entries: The swept keys, and the overrides that all cells share as typed, in the order of the command line.

    Attributes:
        entries: As given.
    """

    def __init__(self, entries: Sequence[SweepAxis | str]) -> None:
        self.entries = entries
        self._sizes = [1 if isinstance(entry, str) else len(entry.values) for entry in entries]

    def __len__(self) -> int:
        return math.prod(self._sizes)

    def __getitem__(self, cell: Any) -> Any:
        if isinstance(cell, slice):
            return [self[each] for each in range(*cell.indices(len(self)))]
        numbers = zip(self.entries, digits(range(len(self))[cell], self._sizes), strict=True)
        given = (entry if isinstance(entry, str) else entry.text(number) for entry, number in numbers)
        return tuple(text for text in given if is_simulated(text))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]

    def runs_of_levels(self) -> Iterator[tuple[SweepAxis | str, int]]:
        """Yield each entry that is simulated, and the number of successive cells that share one of its values."""
        successive = len(self)
        for entry, size in zip(self.entries, self._sizes, strict=True):
            successive //= size
            if is_simulated(entry if isinstance(entry, str) else entry.key):
                yield entry, successive

    def content(self) -> list[Any]:
        """Return the axes in their stored format; see `read_axes`."""
        return [entry if isinstance(entry, str) else _content(entry) for entry in self.entries]


def digits(number: int, sizes: Sequence[int]) -> list[int]:
    """Return the digits of a number in a mixed radix with these sizes; the last digit changes fastest."""
    found = []
    for size in reversed(sizes):
        number, digit = divmod(number, size)
        found.append(digit)
    return found[::-1]


def is_simulated(override: str) -> bool:
    """Return True if a key, or an override of it, affects the simulation, not only how and where it runs."""
    key = split_override(override)[0].partition(".")[0]
    return key not in ("caveats", "hydra", "limits", "outputs", "spec", "sweep")


def _string(text: str) -> str:
    return text if _PLAIN.fullmatch(text) and not _OTHER_KIND.fullmatch(text) else _quoted(text)


def override_value(value: object, string: Callable[[str], str] = _string) -> str:
    """Return a value as written after `KEY=`, so that it is read back as the same value.

    Args:
        value: A number, string, bool, None, or a list or mapping of these.
        string: Returns a string as it is written.
    """
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return string(value)
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{key}:{override_value(each, string)}" for key, each in value.items()) + "}"
    if isinstance(value, Sequence):
        return f"[{','.join(override_value(each, string) for each in value)}]"
    raise TypeError(f"no override holds a {type(value).__name__}")


def _quoted(text: str) -> str:
    from hydra.core.override_parser.types import Quote, QuotedString  # not needed to read a stored sweep

    return QuotedString(text, Quote.single).with_quotes()


def _content(axis: SweepAxis) -> dict[str, Any]:
    values = axis.values
    if isinstance(values, range) and len(values) > _LISTED_UP_TO:
        return {"key": axis.key, "range": [values.start, values.stop, values.step]}
    return {"key": axis.key, "values": list(values)}


def read_axes(content: object) -> Axes:
    """Return stored axes: a list of overrides that all cells share, and of `key` with `values` or `range`.

    A range has start, stop and step.

    Raises:
        StoreError: if the content is not a valid list of axes.
    """
    if not isinstance(content, list):
        raise StoreError("its axes are not a list")
    return Axes([entry if isinstance(entry, str) else _read_axis(entry) for entry in content])


def _read_axis(entry: object) -> SweepAxis:
    if isinstance(entry, Mapping) and isinstance(entry.get("key"), str):
        values, numbers = entry.get("values"), entry.get("range")
        if isinstance(values, list) and values:
            return SweepAxis(entry["key"], values)
        if (
            isinstance(numbers, list)
            and len(numbers) == 3
            and all(type(each) is int for each in numbers)
            and numbers[2]
        ):
            return SweepAxis(entry["key"], range(*numbers))
    raise StoreError("an axis has no key with values or a range")
