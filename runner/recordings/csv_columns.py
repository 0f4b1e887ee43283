"""Numeric columns of a CSV file, checked cell by cell, with line numbers in errors."""

import csv
import math
from array import array
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.base.limits import RECORDING, RECORDING_ROW, RECORDING_ROWS, ExcessError
from runner.base.sanitize import few, quoted

_SEPARATORS = ",;\t"
_MISSING = ("", "nan", "na", "null", "none")
_MOST_TOLD = 5  # problems of one file


def read_csv_columns(path: Path, wanted: Sequence[str]) -> dict[str, FloatArray]:
    """Return columns of a CSV file whose first line names them; commas, semicolons or tabs separate its cells.

    If commas do not separate cells, they may be decimal points.

    Args:
        path: The file.
        wanted: Names of the columns.

    Returns:
        Each column by its name; NaN for a cell that says that its number is missing.

    Raises:
        RunnerError: if it cannot be read, lacks a column, or has a cell without a number; names the line.
    """
    try:
        if excess := RECORDING.excess(path.stat().st_size):
            raise ExcessError(f"it {excess}")
        with path.open(encoding="utf-8-sig", newline="") as file:
            head = file.readline(RECORDING_ROW.most)
            file.seek(0)
            return _columns_of(path, file, max(_SEPARATORS, key=head.count), wanted)
    except (OSError, ExcessError, UnicodeDecodeError, csv.Error) as error:
        raise RunnerError(f"cannot read {path}: {error}") from error


def places_of(path: Path, wanted: Sequence[str], names: Sequence[str]) -> list[int]:
    """Return the indices of the wanted columns among those of a file.

    Raises:
        RunnerError: if one is not there, or stands there twice.
    """
    twice = [name for name in dict.fromkeys(names) if name in wanted and names.count(name) > 1]
    problems = [f"line 1 has the column {quoted(name)} more than once" for name in twice]
    missing = [f"{quoted(name)}{nearest(name, names)}" for name in wanted if name not in names]
    if missing:
        problems.append(f"has no column {few(missing)}; its columns: {few(list(names)) or 'none'}")
    if problems:
        raise _refused(path, problems)
    return [names.index(name) for name in wanted]


def _refused(path: Path, problems: Sequence[str], count: int = 0) -> RunnerError:
    """Return the error that names the first problems of a file; `count` is how many it has."""
    more = max(count, len(problems)) - _MOST_TOLD
    told = [*problems[:_MOST_TOLD], *([f"{more} more problems like these"] if more > 0 else [])]
    return RunnerError(f"{path}: {'; '.join(told)}")


def _rows(file: TextIO, separator: str) -> Iterator[list[str]]:
    """Yield the rows of a CSV file, none longer than allowed: quotes can join all lines to one."""
    held = 0

    def lines() -> Iterator[str]:
        nonlocal held
        for number, line in enumerate(file, start=1):
            held += len(line)
            if excess := RECORDING_ROWS.excess(number) or RECORDING_ROW.excess(held):
                raise ExcessError(f"it {excess}")
            yield line

    for row in csv.reader(lines(), delimiter=separator):
        held = 0
        yield row


def _columns_of(path: Path, file: TextIO, separator: str, wanted: Sequence[str]) -> dict[str, FloatArray]:
    rows = _rows(file, separator)
    names = [name.strip() for name in next(rows, [])]
    places = list(zip(places_of(path, wanted, names), wanted, strict=True))
    found = {name: array("d") for name in wanted}
    problems: list[str] = []
    told, empty = 0, []
    for line, cells in enumerate(rows, start=2):
        if not any(cell.strip() for cell in cells):
            empty.append(f"line {line}: {len(cells)} cells for {len(names)} columns")
            continue
        wrong, empty = empty, []  # at the end of the file they do no harm
        if len(cells) != len(names):
            wrong.append(f"line {line}: {len(cells)} cells for {len(names)} columns")
        for place, name in places if len(cells) == len(names) else ():
            text = cells[place].strip()
            found[name].append(_number(text if separator == "," else text.replace(",", ".")))
            if math.isnan(found[name][-1]) and text.lower() not in _MISSING:
                wrong.append(f"line {line}: {name} is {quoted(text)}; needed: a finite number")
        told += len(wrong)
        problems += wrong[: max(0, _MOST_TOLD - len(problems))]
    if problems:
        raise _refused(path, problems, told)
    return {name: np.array(column) for name, column in found.items()}


def _number(text: str) -> float:
    """Return the finite number in a cell; NaN where there is none."""
    try:
        number = float(text)
    except ValueError:
        return math.nan
    return number if math.isfinite(number) else math.nan
