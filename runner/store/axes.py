"""Axes of a sweep: keys with their typed values, the overrides of each cell, and the levels of each cell."""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.dotted_keys import split_override
from runner.base.errors import RunnerError, StoreError, unknown
from runner.schema.units import read_quantity

_PLAIN = re.compile(r"[\w./+-]+|\$\{[\w.]+\}", re.ASCII)
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
        string: Returns a string as written.
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


@dataclass(frozen=True)
class Axis:
    """Key whose value differs between the cells of a sweep.

    Attributes:
        name: The key, such as "noise.position", or a group, such as "controller".
        values: Distinct values of the key: numbers in ascending order, or strings in order of appearance.
        level: Index into `values` of each cell, shape (cells,).
    """

    name: str
    values: Sequence[float] | Sequence[str]
    level: NDArray[np.intp]

    @cached_property
    def numbers(self) -> FloatArray | None:
        """Values of the axis as numbers, shape (levels,); None for strings."""
        texts = len(self.values) > 0 and isinstance(self.values[0], str)
        return None if texts else np.array(self.values, dtype=float)

    @cached_property
    def unit(self) -> str:
        """Unit of the key; "1" without one."""
        from runner.config.compose.units import key_unit  # models of all kinds, which only reports need

        return key_unit(self.name)

    @property
    def texts(self) -> list[str]:
        """Values of the axis as strings."""
        return [value if isinstance(value, str) else f"{value:g}" for value in self.values]

    def text(self, level: int) -> str:
        """Return the value of a level as a string."""
        value = self.values[level]
        return value if isinstance(value, str) else f"{value:g}"

    def find_level(self, value: object, option: str = "") -> int:
        """Return the level of a number or a string.

        Args:
            value: The value; a number may have a unit, such as 0.05deg.
            option: Option that gave the value, such as "--where robot=macro"; a message begins with it.

        Raises:
            RunnerError: If the axis has no such value; the message lists its values.
        """
        wanted = str(value).strip("'\"")
        typed = read_quantity(wanted)
        number = typed.in_unit(self.unit) if typed else _number(wanted)
        for level, (own, text) in enumerate(zip(self.values, self.texts, strict=True)):
            if wanted == text or (number is not None and number in (own, _number(text))):
                return level
        raise RunnerError(unknown("value", wanted, self.texts, option or self.name))


def find_axis(axes: Sequence[Axis], name: str, option: str = "") -> Axis:
    """Return the axis of a name.

    Args:
        axes: The axes of a sweep.
        name: The name, such as "controller".
        option: Option that gave the name, such as "--by"; a message begins with it.

    Raises:
        RunnerError: If there is no such axis; the message lists the axes.
    """
    names = [axis.name for axis in axes]
    if name not in names:
        raise RunnerError(unknown("axis", name, names, option))
    return axes[names.index(name)]


def find_cells(axes: Sequence[Axis], where: Sequence[str], count: int) -> NDArray[np.intp]:
    """Return the cells of a sweep that have some values.

    Args:
        axes: The axes of the sweep.
        where: The values, each as KEY=VALUE.
        count: Number of cells.

    Raises:
        RunnerError: If there is no such axis or value, or no cell with all of them.
    """
    kept = np.ones(count, dtype=bool)
    for text in where:
        name, given, value = text.partition("=")
        axis = find_axis(axes, name, "--where")
        if not given:
            raise RunnerError(f"--where {text}: no value. Allowed: KEY=VALUE.")
        kept &= axis.level == axis.find_level(value, f"--where {name}")
    if not kept.any():
        raise RunnerError(f"--where: no cell of the sweep has {' and '.join(where)}.")
    return np.flatnonzero(kept)


def group_cells(axes: Sequence[Axis], cells: NDArray[np.intp]) -> list[tuple[list[int], NDArray[np.intp]]]:
    """Return the combinations of the levels of some axes, in ascending order, each with its cells.

    Args:
        axes: The axes; without axes, all cells are one group.
        cells: The cells, shape (n,).
    """
    combination = number_rows([axis.level[cells] for axis in axes], len(cells))
    order = np.argsort(combination, kind="stable")
    groups = np.split(cells[order], np.flatnonzero(np.diff(combination[order])) + 1) if len(cells) else []
    return [([int(axis.level[some[0]]) for axis in axes], some) for some in groups]


def number_rows(columns: Sequence[NDArray[np.intp]], count: int) -> NDArray[np.intp]:
    """Return the number of each row among the distinct rows in ascending order, shape (count,).

    Args:
        columns: Columns of the rows, each of shape (count,); without columns, all rows are equal.
        count: Number of rows.
    """
    if not columns:
        return np.zeros(count, dtype=np.intp)
    if len(columns) == 1:
        return np.asarray(np.unique(columns[0], return_inverse=True)[1])
    return np.asarray(np.unique(np.column_stack(columns), axis=0, return_inverse=True)[1]).ravel()


def axes_of(overrides: Sequence[Sequence[str]]) -> tuple[list[Axis], list[str]]:
    """Return the keys whose values differ between jobs as axes, and the other overrides."""
    axes, fixed = [], []
    columns = _of_grid(overrides) if isinstance(overrides, Axes) else _of_jobs(overrides)
    for key, values, times in columns:
        if isinstance(values, str):
            fixed.append(f"{key}={values}")
        else:
            axis = make_axis(key, values)
            axes.append(replace(axis, level=np.resize(np.repeat(axis.level, times), len(overrides))))
    return axes, fixed


def _of_grid(overrides: Axes) -> Iterator[tuple[str, Sequence[Any], int]]:
    """Yield keys, their values in turn (a string if all cells share it), and the number of cells for each value."""
    entries = [*overrides.runs_of_levels()]
    swept = [entry.key.lstrip("+") for entry, _ in entries if not isinstance(entry, str)]
    for entry, times in entries:
        if isinstance(entry, str) or all(value == entry.values[0] for value in entry.values):
            key, text = split_override(entry if isinstance(entry, str) else entry.text(0))
            yield key, text, times
        else:
            key = entry.key.lstrip("+")
            of_keys = swept.count(key) > 1 and all(isinstance(value, Mapping) for value in entry.values)
            yield f"{key}{{}}" if of_keys else key, entry.values, times


def _of_jobs(overrides: Sequence[Sequence[str]]) -> Iterator[tuple[str, Sequence[Any], int]]:
    """Yield keys, their values by job (a string if all jobs share it), and 1."""
    given = [_by_key(job) for job in overrides]
    for key in dict.fromkeys(key for job in given for key in job if is_simulated(key)):
        texts = [job.get(key, "") for job in given]
        numbers = [_number(text) for text in texts]
        yield key, texts[0] if len(set(texts)) == 1 else texts if None in numbers else numbers, 1


def _by_key(job: Sequence[str]) -> dict[str, str]:
    """Return the values of a job by key: the last of each key, and with it the mappings of the key."""
    found: dict[str, str] = {}
    for key, text in map(split_override, job):
        both = key in found and "{" in (found[key][:1], text[:1])
        found[key] = f"{found[key]} {text}" if both else text
    return found


def make_axis(name: str, values: Sequence[Any]) -> Axis:
    """Return the axis of a key with its value in each cell, shape (cells,)."""
    if isinstance(values, range) or all(type(value) in (int, float) and np.isfinite(value) for value in values):
        numbers, level = np.unique(np.array(values, dtype=float), return_inverse=True)
        return Axis(name, numbers.tolist(), level)
    texts = [value.strip("'\"") if isinstance(value, str) else override_value(value) for value in values]
    place = {text: index for index, text in enumerate(dict.fromkeys(texts))}
    return Axis(name, list(place), np.array([place[text] for text in texts], dtype=np.intp))


def _number(text: str) -> float | None:
    """Return the value of an override if it is a finite number, otherwise None."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if np.isfinite(number) else None
