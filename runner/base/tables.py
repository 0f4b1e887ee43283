"""Tables: columns of numbers in text and Parquet files, recognised by content.

In text, commas, semicolons, tabs or blanks separate the cells. A cell may hold a list of numbers, and a row one joint
at a time. Lines of comments may stand above the names of the columns, and a line of units below them. If commas do not
separate cells, they may be decimal points. Dates with times, as in ISO 8601, count in s since 1970.
"""

import csv
import math
import re
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from itertools import chain
from operator import itemgetter
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import TableError, nearest
from runner.base.limits import (
    RECORDING,
    RECORDING_NUMBERS,
    RECORDING_ROW,
    RECORDING_ROWS,
    ExcessError,
    Limit,
)
from runner.base.parquet import PARQUET, number_columns, open_columns
from runner.base.row_forms import by_joint, coded_rows, flat_names, flat_rows, joint_column, list_widths, with_points
from runner.base.sanitize import few, quoted

MISSING = ("", "nan", "na", "null", "none", "-nan", "nan(ind)", "-nan(ind)")
"""Cells without a number, in lower case."""

_COMMENTS = ("#", "%", "//")
_MOMENT = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:")  # of ISO 8601
_HEAD = 200  # lines, all but the last two may be comments
_SAMPLE = 50  # rows from which columns of numbers are found
_MOST_TOLD = 5  # problems of one file


def first_problems(problems: Sequence[str], count: int) -> list[str]:
    """Return the first of a number of problems of a file, and how many follow."""
    more = count - _MOST_TOLD
    return [*problems[:_MOST_TOLD], *([f"{more} more problems like these"] if more > 0 else [])]


@dataclass(frozen=True)
class NumericTable:
    """Columns of numbers.

    Attributes:
        path: Its file or folder.
        form: Words for its format.
        columns: Each column by its name, shape (N,); NaN for a cell without a number.
        units: Unit of a column by the file's line of units.
        lines: Number of each row's line in the file, shape (N,); None for a file without lines.
        others: Columns that hold no numbers, each with the text that its first rows have in common.
        notes: Messages for a user: rows that are left out, and parts of the file that cannot be read.
    """

    path: Path
    form: str
    columns: dict[str, FloatArray]
    units: dict[str, str] = field(default_factory=dict)
    lines: NDArray[np.int64] | None = None
    others: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def place(self, row: int) -> str:
        """Return the label of a row in messages."""
        return f"row {row + 1}" if self.lines is None else f"line {self.lines[row]}"

    def of(self, names: Sequence[str], time: str | None = None) -> "NumericTable":
        """Return some columns, without the rows in which all of them but the time are empty.

        Args:
            names: Names of the columns, the time included.
            time: The column of the time; None if rows have an even rate: then all rows stay.

        Raises:
            RunnerError: if a column is not there.
        """
        self.require(names)
        columns = {name: self.columns[name] for name in names}
        signals = [column for name, column in columns.items() if name != time]
        if time is None or not signals or not len(self):
            return replace(self, columns=columns)
        kept = ~np.logical_and.reduce([np.isnan(column) for column in signals])
        return replace(self, columns=columns)._only(kept, "without any of the columns")

    def _only(self, kept: NDArray[np.bool_], why: str) -> "NumericTable":
        if kept.all():
            return self
        return replace(
            self,
            columns={name: column[kept] for name, column in self.columns.items()},
            lines=None if self.lines is None else self.lines[kept],
            notes=(*self.notes, f"{np.sum(~kept):,} rows {why} are left out"),
        )

    def only(self, names: Sequence[str]) -> "NumericTable":
        """Return some columns.

        Raises:
            RunnerError: if a column is not there.
        """
        self.require(names)
        return replace(self, columns={name: self.columns[name] for name in names})

    def require(self, names: Sequence[str]) -> None:
        """Check that the columns are there.

        Raises:
            RunnerError: if one is not, or has no numbers; names what there is.
        """
        known = list(self.columns)
        if missing := [name for name in names if name not in self.columns]:
            shown = [
                f"{quoted(name)}{' with numbers' * (name in self.others)}{nearest(name, known)}" for name in missing
            ]
            raise TableError(self.path, f"has no column {few(shown)}; its columns: {few(known) or 'none'}")


@dataclass(frozen=True)
class _Layout:
    """Layout of a text file: separator (empty for blanks), names, units, and the line before the first row."""

    separator: str
    names: Sequence[str]
    units: Sequence[str]
    before: int

    def cells(self, lines: Iterable[str]) -> Iterator[list[str]]:
        return csv.reader(lines, delimiter=self.separator) if self.separator else map(str.split, lines)


Wanted = Sequence[str] | Callable[[Sequence[str]], Sequence[str]]
"""The columns to read, or a function that chooses them from the names of all."""


def read_table(path: Path, wanted: Wanted | None = None, limit: Limit = RECORDING) -> NumericTable:
    """Return the columns of a text or Parquet file.

    Args:
        path: The file.
        wanted: The columns to read, each of whose cells holds a number or nothing; None for all that hold numbers.
        limit: Upper limit of its size, unpacked.

    Raises:
        TableError: if it is not a table, or lacks a column.
        OSError: if it cannot be read.
        ExcessError: if it is too large.
    """
    if excess := limit.excess(path.stat().st_size):
        raise ExcessError(f"it {excess}")
    with path.open("rb") as file:
        head = file.read(4096)
    if head.startswith(PARQUET):
        read = open_columns(path, limit=limit)
        columns, others = number_columns(read, {})
        table = NumericTable(path, "Parquet", columns, others=others)
        chosen = wanted(read.column_names) if callable(wanted) else wanted
        return table if chosen is None else table.only(chosen)
    if b"\0" in head:
        raise TableError(path, "is neither text nor Parquet")
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as text:
        return read_text_table(path, text, wanted)


def read_text_table(path: Path, file: TextIO, wanted: Wanted | None = None, form: str = "text") -> NumericTable:
    """Return the columns of a text file.

    Args:
        path: Its path, for messages.
        file: The open file; it is read twice.
        wanted: The only columns to read: each of their cells must hold a number or say that it is missing. None reads
            each column that has numbers.
        form: Words for what the text is, such as "text in a zip file".

    Raises:
        RunnerError: if it is not a table, lacks a column, or has a cell without a number; names the line.
        ExcessError: if it is too large.
    """
    layout = _layout(path, file)
    rows, names, sample, every = _open(path, file, layout)
    separated = {"": "blanks", "\t": "tabs", ",": "commas", ";": "semicolons"}[layout.separator]
    form = f"{form}, cells separated by {separated}"
    chosen = wanted(names) if callable(wanted) else wanted
    joint = joint_column(names)
    if joint is not None and (chosen is None or not set(chosen) <= set(names)):
        long = _read_long(path, rows, names, sample, every, joint, strict=chosen is not None)
        if long is not None:
            table = NumericTable(path, f"{form}, a row for each joint", long[0], lines=long[1], notes=long[2])
            return table if wanted is None else table.only(wanted(list(long[0])) if callable(wanted) else wanted)
        rows, names, sample, every = _open(path, file, layout)
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1 and (chosen is None or name in chosen)]
    if twice and chosen is not None:
        raise TableError(path, f"has the column {quoted(twice[0])} more than once")
    numeric = [place for place, name in enumerate(names) if name not in twice and _has_numbers(sample, place)]
    others = {name: _text(sample, place) for place, name in enumerate(names) if place not in numeric}
    if chosen is not None:
        NumericTable(path, form, dict.fromkeys(names, np.empty(0))).require(chosen)
        numeric = [names.index(name) for name in chosen]
    numbers, lines, notes = _Numbers(path, names, numeric, strict=chosen is not None).read(every, rows)
    units = {name: unit for name, unit in zip(names, layout.units, strict=False) if unit}
    columns = {names[place]: numbers[:, index] for index, place in enumerate(numeric)}
    return NumericTable(path, form, columns, units, lines, others, notes)


def _open(
    path: Path, file: TextIO, layout: "_Layout"
) -> tuple["_Rows", list[str], list[tuple[int, list[str]]], Iterator[tuple[int, list[str]]]]:
    """Return the rows of a file from its start, names of the columns, the first rows, and all rows, without lists."""
    file.seek(0)
    rows = _Rows(file, layout)
    sample = list(_first(rows, _SAMPLE))
    widths = list_widths(sample, layout.names)
    if not widths:
        return rows, list(layout.names), sample, chain(sample, rows)
    flat = list(flat_rows(path, sample, layout.names, widths))
    rest = flat_rows(path, rows, layout.names, widths)
    return rows, flat_names(layout.names, widths), flat, chain(flat, rest)


def _read_long(
    path: Path, rows: "_Rows", names: list[str], sample: Sequence[tuple[int, list[str]]],
    every: Iterator[tuple[int, list[str]]], joint: int, strict: bool,
) -> tuple[dict[str, FloatArray], NDArray[np.int64], tuple[str, ...]] | None:  # fmt: skip
    """Return a table with a row for each joint as one with a row for each time; None if it is another one."""
    places = [place for place in range(len(names)) if place == joint or _has_numbers(sample, place)]
    codes: dict[str, int] = {}
    numbers, lines, notes = _Numbers(path, names, places, strict).read(coded_rows(every, joint, codes), rows)
    labels = [f"{names[joint]}{text}" if text.isdigit() else text for text in codes]
    found = by_joint(path, [names[place] for place in places], numbers, lines, places.index(joint), labels)
    return None if found is None else (*found, notes)


def _layout(path: Path, file: TextIO) -> _Layout:
    """Return the layout of a text file; the file is read up to its second line without comment."""
    comments: list[str] = []
    found: list[tuple[int, str]] = []
    for number in range(1, _HEAD + 1):
        line = file.readline(RECORDING_ROW.most + 2)
        if excess := RECORDING_ROW.excess(len(line)):
            raise ExcessError(f"it {excess}")
        if not line or len(found) == 2:
            break
        if line.startswith(_COMMENTS):
            comments.append(line.lstrip("#%/ "))
        elif line.strip():
            found.append((number, line))
    if not found:
        raise TableError(path, "is empty. Allowed: rows of numbers.")
    (number, first), *second = found
    separator = ";" if first.count(";") else max(",\t", key=first.count)
    layout = _Layout(separator if separator in first else "", (), (), number)
    (cells,) = layout.cells([first])
    if any(number_in(_with_point(cell, layout.separator)) is not None for cell in cells):
        (above,) = layout.cells(comments[-1:]) if comments else ([],)
        if len(above) != len(cells) and comments:
            above = comments[-1].replace(",", " ").split()
        names = above if len(above) == len(cells) else [f"column {place + 1}" for place in range(len(cells))]
        return replace(layout, names=[name.strip() for name in names], before=number - 1)
    names = [cell.strip() for cell in cells]
    if not names[-1]:
        names.pop()
    if second:
        (below,) = layout.cells([second[0][1]])
        words = [cell.strip() for cell in below]
        if any(words) and len(names) <= len(words) <= len(names) + 1 and not any(map(_is_cell, words)):
            return replace(layout, names=names, units=[word.strip("[]() ") for word in words], before=second[0][0])
    return replace(layout, names=names)


class _Rows:
    """Rows of cells with the numbers of their lines; none is longer than allowed, as quotes can join all lines."""

    def __init__(self, file: TextIO, layout: _Layout) -> None:
        self._file, self._layout = file, layout
        self._number = self._held = 0
        self.whole = True  # whether the line read last has an end
        self._iterator = self._read()

    def __iter__(self) -> Iterator[tuple[int, list[str]]]:
        return self._iterator

    def _read(self) -> Iterator[tuple[int, list[str]]]:
        for cells in self._layout.cells(self._lines()):
            self._held = 0
            yield self._number, cells

    def _lines(self) -> Iterator[str]:
        before, points = self._layout.before, self._layout.separator != ","
        for number, line in enumerate(self._file, start=1):
            self._number = number
            if number <= before:
                continue
            self._held += len(line)
            if excess := RECORDING_ROWS.excess(number) or RECORDING_ROW.excess(self._held):
                raise ExcessError(f"it {excess}")
            if line[0] in "#%" or line.startswith("//"):
                continue
            self.whole = line[-1] == "\n"
            yield with_points(line) if points and "," in line else line


def _first(rows: Iterable[tuple[int, list[str]]], count: int) -> Iterator[tuple[int, list[str]]]:
    for index, row in enumerate(rows, start=1):
        yield row
        if index == count:
            return


def _has_numbers(sample: Sequence[tuple[int, list[str]]], place: int) -> bool:
    cells = [row[place].strip() for _, row in sample if place < len(row)]
    return bool(cells) and all(map(_is_cell, cells))


def _text(sample: Sequence[tuple[int, list[str]]], place: int) -> str:
    """Return the text that all rows have in a column; empty if they differ."""
    texts = {row[place].strip() for _, row in sample if place < len(row)}
    return texts.pop() if len(texts) == 1 else ""


def _is_cell(text: str) -> bool:
    """Return whether a cell holds a number, or says that it is missing."""
    return text.lower() in MISSING or number_in(_with_point(text, "")) is not None


def _with_point(text: str, separator: str) -> str:
    return text.strip() if separator == "," else text.strip().replace(",", ".")


def number_in(text: str) -> float | None:
    """Return the number in a text, of a date with a time in s since 1970; None if there is none."""
    try:
        return float(text)
    except ValueError:
        pass
    try:
        moment = datetime.fromisoformat(text) if _MOMENT.match(text) else None
    except ValueError:
        return None
    return None if moment is None else (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


class _Numbers:
    """Numbers of some columns of a text file.

    Args:
        path: The file.
        names: Names of all columns.
        places: Indices of the columns.
        strict: Whether a cell with other text is an error; otherwise it counts as missing.
    """

    def __init__(self, path: Path, names: Sequence[str], places: Sequence[int], strict: bool) -> None:
        self._path, self._names, self._places, self._strict = path, names, places, strict
        self._problems: list[str] = []
        self._told = 0

    def read(
        self, rows: Iterable[tuple[int, list[str]]], source: _Rows
    ) -> tuple[FloatArray, NDArray[np.int64], tuple[str, ...]]:
        """Return the numbers, shape (N, n), the line of each row, and messages for a user."""
        data, lines, count = array("d"), array("q"), len(self._names)
        most = max(1, max(self._places, default=0) + 1)
        pick: Callable[[list[str]], Sequence[str]] = (
            itemgetter(*self._places)
            if len(self._places) > 1
            else lambda cells: [cells[place] for place in self._places]
        )
        cut: tuple[int, int] | None = None
        for line, cells in rows:
            if cut is not None:
                self._tell(*cut)
                cut = None
            if len(cells) != count and not (len(cells) == count + 1 and not cells[-1].strip()):
                if any(cell.strip() for cell in cells):
                    cut = (line, len(cells))  # at the end of the file it is what a killed logger leaves
                continue
            try:
                data.fromlist(list(map(float, pick(cells))))
            except ValueError:
                data.fromlist([self._cell(line, place, cells[place].strip()) for place in self._places])
            lines.append(line)
            if not len(lines) % 1000 and (excess := RECORDING_NUMBERS.excess(len(data))):
                raise ExcessError(f"it {excess}")
        notes = []
        if cut is not None and source.whole:
            self._tell(*cut)
        elif cut is not None:
            notes.append(f"the last line, {cut[0]}, is cut off and left out")
        numbers = np.frombuffer(data, dtype=np.float64).reshape(len(lines), -1) if len(data) else np.empty((0, most))
        self._refuse_infinite(numbers, lines)
        if self._problems:
            raise TableError(self._path, *first_problems(self._problems, self._told))
        return numbers, np.frombuffer(lines, dtype=np.int64) if lines else np.empty(0, dtype=np.int64), tuple(notes)

    def _refuse_infinite(self, numbers: FloatArray, lines: Sequence[int]) -> None:
        for row, column in np.argwhere(np.isinf(numbers))[: _MOST_TOLD + 1] if self._strict else ():
            self._add(f"line {lines[row]}: {self._names[self._places[column]]} is 'inf'; allowed: a finite number")

    def _cell(self, line: int, place: int, text: str) -> float:
        found = number_in(text)
        if found is not None:
            return found
        if self._strict and text.lower() not in MISSING:
            self._add(f"line {line}: {self._names[place]} is {quoted(text)}; allowed: a finite number")
        return math.nan

    def _tell(self, line: int, cells: int) -> None:
        self._add(f"line {line}: {cells} cells for {len(self._names)} columns")

    def _add(self, problem: str) -> None:
        self._told += 1
        if len(self._problems) < _MOST_TOLD:
            self._problems.append(problem)
