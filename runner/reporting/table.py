"""Tables of typed cells, with their text in reports and on a terminal."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, Literal

from runner.base.quantities import (
    ROUNDING,
    choose_unit,
    fewest_powers,
    label_with_unit,
    number,
    plain_number,
    smaller_units,
)
from runner.base.sanitize import one_line
from runner.reporting.block import ReportBlock
from runner.reporting.markup import literal

PLAIN = 1e-4
"""Smallest number of a column that is a plain decimal in a smaller unit, such as 0.0011 mm."""


@dataclass(frozen=True)
class Origin:
    """Origin of a figure or table: its number in the source, the command that makes it, the commit."""

    number: str = ""
    command: str = ""
    commit: str = ""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        title: Its title, without the unit.
        kind: Content of its cells: text; numbers, flush right; the SI unit of the numbers in a row; what is typed on
            the command line, in monospace; or a verdict or grade, as a badge.
        unit: SI unit of its numbers. Reports show the unit that fits all of them.
    """

    title: str
    kind: Literal["text", "number", "unit", "code", "badge"] = "text"
    unit: str = "1"


@dataclass(frozen=True)
class Number:
    """A number in a table, in the unit of its column.

    Attributes:
        value: The number: infinite beyond every number, None if it is missing.
        low: Lower end of its interval; None for no interval.
        high: Upper end of its interval.
        digits: Number of significant digits in reports.
    """

    value: float | None
    low: float | None = None
    high: float | None = None
    digits: int = 3

    @property
    def is_rounding(self) -> bool:
        """True if number and ends are what rounding leaves of zero."""
        ends = [abs(end) for end in (self.value, self.low, self.high) if end is not None]
        return any(ends) and max(ends) < ROUNDING

    def text(self, write: Callable[[float | None], str]) -> str:
        """Return the number and its interval, each written by a function; an interval without a number: "1 to 2"."""
        if self.low is None:
            return write(self.value)
        ends = f"{write(self.low)} to {write(self.high)}"
        return ends if self.value is None else f"{write(self.value)} ({ends})"


Cell = str | Number


def numbers(*titles: str) -> list[str | Column]:
    """Return columns of numbers without a common unit."""
    return [Column(title, "number") for title in titles]


@dataclass(frozen=True)
class Table(ReportBlock):
    """A table.

    Attributes:
        caption: What it lists; inline mathematics as in Text.
        header: Its columns; a string is the title of a text column.
        rows: Cells, one sequence per row, each as long as the header.
        origin: Its number in the source, command and commit.
        folded: True if HTML shows it only on a click, and paper not at all.
        prose: True if titles and strings may have inline mathematics as in Text; otherwise a dollar sign is literal.
    """

    block: ClassVar[str] = "table"
    word: ClassVar[str] = "table"
    actions: ClassVar[tuple[str, ...]] = ("csv",)
    caption: str
    header: Sequence[str | Column]
    rows: Sequence[Sequence[Cell]]
    origin: Origin = field(default_factory=Origin)
    folded: bool = False
    prose: bool = False

    @cached_property
    def columns(self) -> list[Column]:
        """All columns."""
        return [Column(each) if isinstance(each, str) else each for each in self.header]

    @cached_property
    def lines(self) -> list[list[str]]:
        """The titles with units, and the rows, as strings with inline mathematics: three digits, one unit a column."""
        columns = [_column_texts(each, [row[place] for row in self.rows]) for place, each in enumerate(self.columns)]
        lines = [[column[place] for column in columns] for place in range(1 + len(self.rows))]
        return lines if self.prose else [[literal(text) for text in line] for line in lines]

    def texts(self) -> Iterator[str]:
        """Yield the caption and the cells."""
        yield self.caption
        for line in self.lines:
            yield from line


def _column_texts(column: Column, cells: Sequence[Cell]) -> list[str]:
    """Return the title and the cells of a column in the unit that fits all of its numbers."""
    values = [cell.value for cell in cells if isinstance(cell, Number)]
    known = [value for value in values if value is not None and math.isfinite(value)]
    factor, unit = 1.0, column.unit
    if any(abs(value) >= ROUNDING for value in known) and not any(map(_is_text_of_number, cells)):
        factor, unit = fit_unit(known, unit)
    plain = 1e-2 if factor == 1.0 else PLAIN

    def write(cell: Cell) -> str:
        if isinstance(cell, str):
            return cell
        return cell.text(lambda value: number(
            None if value is None else factor * value, cell.digits, factor * ROUNDING, plain=plain
        ))  # fmt: skip

    return [label_with_unit(column.title, unit), *map(write, cells)]


def _is_text_of_number(cell: Cell) -> bool:
    """Return True for a string with a number in it, which cannot be converted to another unit."""
    return isinstance(cell, str) and any(letter.isdigit() for letter in cell)


def fit_unit(values: Sequence[float], unit: str) -> tuple[float, str]:
    """Return the factor and the unit in which the fewest numbers of a column need a power of ten.

    Args:
        values: Finite numbers in the SI unit.
        unit: The SI unit.
    """
    largest = choose_unit(max(map(abs, values), default=0.0), unit)
    factor, name = fewest_powers(values, [largest, *smaller_units(unit)], PLAIN)
    return factor, unit if factor == 1.0 else name


def terminal(table: Table, indent: str = "  ") -> str:
    """Return a table as aligned lines in SI units: titles unless all are empty, and rows; the cells are sanitized."""
    titles = [[label_with_unit(column.title, column.unit) for column in table.columns]]
    rows = [[cell if isinstance(cell, str) else cell.text(plain_number) for cell in row] for row in table.rows]
    cells = [[one_line(cell) for cell in row] for row in (titles if any(titles[0]) else []) + rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in cells)
    return "\n".join(f"{indent}{line}".rstrip() for line in lines)
