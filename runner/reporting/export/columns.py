"""Tables for papers: a unit and power of ten per column, digits by the interval; Markdown and Typst."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

from runner.base.quantities import ROUNDING, SUPERSCRIPT, unit_text
from runner.base.sanitize import plain
from runner.reporting.table import Cell, Number, Table, fit_unit

_SMALLEST, _LARGEST = 1e-2, 1e5  # outside of these the head of a column has a power of ten
_DIGITS = 3  # of a number without interval
_MOST_DIGITS = 6
BEYOND, MISSING = "∞", "–"
_MARKDOWN = re.compile(r"([\\`*{}|~$!])|(?<![^\W_])(_)|(_)(?![^\W_])")  # an underscore within a word is itself


class ScaledUnit(NamedTuple):
    """A unit such as "mm", "N m" or "m/s^2", with a power of ten before it.

    Attributes:
        name: The unit; "1" for none.
        power: The exponent; 0 for none.
    """

    name: str
    power: int = 0

    def __str__(self) -> str:
        """Return the unit as read and never broken, such as "10⁻⁶ N m"; an empty string for 1."""
        power = f"10{str(self.power).translate(SUPERSCRIPT)}" if self.power else ""
        return f"{power} {unit_text(self.name)}".strip().replace(" ", "\u00a0")


class Written(NamedTuple):
    """A cell as a string.

    Attributes:
        text: The string; "∞" for a number beyond every number, "–" for a missing one.
        low: Lower end of the interval, or "".
        high: Upper end, or "".
        unit: The unit that it names, or None.
    """

    text: str
    low: str = ""
    high: str = ""
    unit: ScaledUnit | None = None

    def with_interval(self, form: str) -> str:
        """Return the cell with its interval, such as "4.1 [3.9, 4.4]" in the form "[{}, {}]"."""
        return f"{self.text} {form.format(self.low, self.high)}" if self.low else self.text


class PaperColumn(NamedTuple):
    """A column of a table for a paper.

    Attributes:
        title: Its title, without unit; may be empty for numbers.
        kind: As in Column.
        cells: One for each row.
        unit: Unit of all of its numbers; None for other cells.
    """

    title: str
    kind: str
    cells: Sequence[Written]
    unit: ScaledUnit | None = None

    @property
    def has_intervals(self) -> bool:
        """True if any of its cells has an interval."""
        return any(cell.low for cell in self.cells)

    @property
    def head(self) -> str:
        """Title and unit, such as "error (mm)"."""
        unit = "" if self.unit is None else str(self.unit)
        untitled = "median, 95 % interval" if self.has_intervals else "median"
        return f"{self.title} ({unit})" if unit else self.title or untitled


def lay_out(table: Table) -> list[PaperColumn]:
    """Return the columns of a table for a paper.

    If a column has the unit of each row, it shows the unit and power of ten that fit the numbers of that row.
    """
    laid = []
    units = next(([str(row[place]) for row in table.rows] for place, each in enumerate(table.columns)
                  if each.kind == "unit"), None)  # fmt: skip
    for place, column in enumerate(table.columns):
        cells = [row[place] for row in table.rows]
        if not any(isinstance(cell, Number) for cell in cells):
            laid.append(PaperColumn(column.title, column.kind, [Written(str(cell)) for cell in cells]))
        elif units is None:
            unit, written = _write(cells, column.unit)
            laid.append(PaperColumn(column.title, column.kind, written, unit))
        else:
            rows = [_write([cell], unit) for cell, unit in zip(cells, units, strict=True)]
            shown = [Written(str(unit), unit=unit) for unit, _ in rows]
            laid = [each._replace(cells=shown) if each.kind == "unit" else each for each in laid]
            laid.append(PaperColumn(column.title, column.kind, [cell for _, (cell,) in rows], ScaledUnit("1")))
    return laid


def _write(cells: Sequence[Cell], unit: str) -> tuple[ScaledUnit, list[Written]]:
    """Return the unit that fits some numbers, and these in that unit."""
    ends = [end for cell in cells if isinstance(cell, Number) for end in (cell.value, cell.low, cell.high)]
    known = [end for end in ends if end is not None and math.isfinite(end) and abs(end) >= ROUNDING]
    factor, name = fit_unit(known, unit)
    largest = factor * max(map(abs, known), default=0.0)
    power = 0 if largest == 0.0 or _SMALLEST <= largest < _LARGEST else 3 * math.floor(math.log10(largest) / 3)
    scale = factor * 10.0**-power
    written = [_text(cell, scale) if isinstance(cell, Number) else Written(cell) for cell in cells]
    return ScaledUnit(name, power), written


def _text(cell: Number, scale: float) -> Written:
    if cell.value is None:
        return Written(MISSING)
    ends = [end for end in (cell.value, cell.low, cell.high) if end is not None]
    places = decimals(*(scale * end for end in ends))
    zeros = all(abs(end) < ROUNDING for end in ends)
    text, low, high = [*("0" if zeros else _fixed(scale * end, places) for end in ends), "", ""][:3]
    return Written(text, low, high)


def decimals(median: float, low: float | None = None, high: float | None = None) -> int:
    """Return to how many decimals a median is given: to the second digit of the half width of its interval.

    At most six digits; three without an interval. Within these, the ends of an interval without 0
    are not rounded to 0.
    """
    finite = [value for value in (low, median, high) if value is not None and math.isfinite(value)]
    half = (max(finite) - min(finite)) / (2.0 if len(finite) == 3 else 1.0) if finite else 0.0
    size = max(map(abs, finite), default=0.0)
    if size == 0.0:
        return 0
    leading = math.floor(math.log10(size))
    wanted = 1 - math.floor(math.log10(half)) if half > 0.0 else _DIGITS - 1 - leading
    most = _MOST_DIGITS - 1 - leading
    has_zero = min(finite) <= 0.0 <= max(finite)
    first = 0 if has_zero else -math.floor(math.log10(min(map(abs, finite))))
    return max(0, min(wanted, most), first if first <= most else 0)


def _fixed(value: float, places: int) -> str:
    if math.isinf(value):
        return BEYOND if value > 0 else f"-{BEYOND}"
    text = f"{value:.{places}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


# pandoc reads a bracket behind a backslash as the beginning of a formula.
_ENTITIES = {"&": "&amp;", "#": "&#35;", "<": "&lt;", ">": "&gt;", "[": "&#91;", "]": "&#93;"}


def write_markdown(table: Table) -> str:
    """Return a table in GitHub's Markdown."""
    columns = lay_out(table)
    lines = [[escape_markdown(text) for text in line] for line in _lines(columns, "({} to {})")]
    marks = ["---:" if each.kind == "number" else "---" for each in columns]
    return "\n".join("| " + " | ".join(line) + " |" for line in [lines[0], marks, *lines[1:]])


def escape_markdown(text: str) -> str:
    """Return a string in which Markdown finds no markup."""
    safe = plain(text)
    for letter, entity in _ENTITIES.items():
        safe = safe.replace(letter, entity)
    return _MARKDOWN.sub(lambda found: f"\\{found[0]}", safe)


def _lines(columns: Sequence[PaperColumn], interval: str) -> list[list[str]]:
    cells = ([cell.with_interval(interval) for cell in each.cells] for each in columns)
    return [[each.head for each in columns], *map(list, zip(*cells, strict=True))]
