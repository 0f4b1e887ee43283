"""Logs in JSON: an object on each line, an array of objects, or an object of arrays.

Nested objects and lists become names such as state.q.0. A value that is not there, or null, is missing in its row.
"""

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.bounded_json import decode_json
from runner.base.errors import TableError
from runner.base.limits import RECORD, RECORDING_NUMBERS, RECORDING_ROW, RECORDING_ROWS, ExcessError, read_text
from runner.base.sanitize import one_line, quoted
from runner.base.tables import MISSING, NumericTable, number_in

_WIDEST = 1000  # numbers in a list
_ALIKE = 0.9  # of a list's lengths, from which on another one is an error
_HEAD, _FIRST = 4096, 10  # bytes and lines that show the form
_STAMPS = ((".sec", ".nanosec"), (".secs", ".nsecs"), (".sec", ".nsec"))  # of ROS: a whole number of s and of ns
_ALLOWED = "Allowed: an object on each line, an array of objects, or an object of arrays."


def is_json(path: Path) -> bool:
    """Return whether a file begins with an object of JSON, or with an array of objects."""
    with path.open("rb") as file:
        start = b"".join(file.read(_HEAD).removeprefix(b"\xef\xbb\xbf").split())[:2]
    return start in (b'{"', b"[{")


def read_json(path: Path) -> NumericTable:
    """Return the columns of a log in JSON.

    Raises:
        TableError: if it is none, is nested too deep, or has a list of another length in one row; names the line.
        ExcessError: if it is too large.
    """
    notes: list[str] = []
    if _has_lines(path):
        return _table(path, "JSON lines", _lines(path, notes), notes)
    try:
        whole = decode_json(read_text(path, RECORD).removeprefix("\ufeff"))
    except (ExcessError, UnicodeDecodeError):
        raise
    except ValueError as error:
        raise TableError(path, f"is not JSON: {one_line(str(error))}") from error
    rows = whole if isinstance(whole, list) else _transposed(path, whole)
    return _table(path, "JSON", ((f"row {number}", row) for number, row in enumerate(rows, start=1)), notes)


def _has_lines(path: Path) -> bool:
    """Return whether the first two lines that are not blank are an object each."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        lines = [line for _ in range(_FIRST) if (line := file.readline(RECORDING_ROW.most + 2)).strip()][:2]
    if len(lines) < 2:
        return False
    try:
        return all(isinstance(decode_json(line), dict) for line in lines)
    except ValueError:
        return all(line.startswith("{") and line.rstrip().endswith("}") for line in lines)


def _lines(path: Path, notes: list[str]) -> Iterator[tuple[str, Any]]:
    """Yield each object with its line; the last line may be cut off, as a killed logger leaves it."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        number = 0
        while line := file.readline(RECORDING_ROW.most + 2):
            number += 1
            if excess := RECORDING_ROWS.excess(number) or RECORDING_ROW.excess(len(line)):
                raise ExcessError(f"it {excess}")
            if not line.strip():
                continue
            try:
                yield f"line {number}", decode_json(line)
            except ValueError as error:
                if line.endswith("\n"):
                    raise TableError(path, f"line {number}: is not JSON: {one_line(str(error))}") from error
                notes.append(f"the last line, {number}, is cut off and left out")


def _transposed(path: Path, whole: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield a row for each place of the arrays in an object that are as long as most of them."""
    arrays = dict(_arrays("", whole))
    if not arrays:
        raise TableError(path, f"has no rows. {_ALLOWED}")
    (length, _), *_ = Counter(map(len, arrays.values())).most_common(1)
    chosen = {name: one for name, one in arrays.items() if len(one) == length}
    return (dict(zip(chosen, row, strict=True)) for row in zip(*chosen.values(), strict=True))


def _arrays(name: str, value: Any) -> Iterator[tuple[str, list[Any]]]:
    if isinstance(value, list) and len(value) > 1:
        yield name, value
    elif isinstance(value, dict):
        for key, one in value.items():
            yield from _arrays(f"{name}.{key}" if name else key, one)


class _Column:
    """Numbers of a name, as many in each row: one, or those of a list."""

    def __init__(self, width: int) -> None:
        self.width, self.numbers = width, array("d")

    def put(self, row: int, numbers: Sequence[float]) -> bool:
        """Add the numbers of a row, after missing ones of rows without any; return False if it has some already."""
        lacking = row * self.width - len(self.numbers)
        if lacking < 0:
            return False
        if lacking:
            self.numbers.extend([np.nan] * lacking)
        self.numbers.extend(numbers)
        return True


class _Columns:
    """Columns of numbers and texts that grow with each row."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._place = ""
        self._single: dict[str, _Column] = {}
        self._lists: dict[str, _Column] = {}
        self._lengths: dict[str, Counter[int]] = {}
        self._first: dict[tuple[str, int], str] = {}
        self._width = 0
        self.texts: dict[str, str] = {}
        self.rows = 0

    def add(self, place: str, row: Any) -> None:
        self._place = place
        if not isinstance(row, dict):
            raise TableError(self._path, f"{place}: is {quoted(row)}; allowed: an object")
        for name, value in row.items():
            self._take(name, value)
        self.rows += 1
        if not self.rows % 1000 and (excess := RECORDING_NUMBERS.excess(self.rows * self._width)):
            raise ExcessError(f"it {excess}")

    def _take(self, name: str, value: Any) -> None:
        if isinstance(value, dict):
            for key, one in value.items():
                self._take(f"{name}.{key}", one)
        elif isinstance(value, list):
            self._take_list(name, value)
        elif isinstance(value, str):
            number = np.nan if value.strip().lower() in MISSING else number_in(value)
            if number is None:
                self.texts[name] = value if self.texts.get(name, value) == value else ""
            else:
                self._put(self._single, name, [number], 1)
        else:
            self._put(self._single, name, [np.nan if value is None else value], 1)

    def _take_list(self, name: str, value: list[Any]) -> None:
        self._lengths.setdefault(name, Counter())[len(value)] += 1
        self._first.setdefault((name, len(value)), self._place)
        kinds = set(map(type, value))
        if not kinds <= {float, int, bool, type(None)}:
            for index, one in enumerate(value[:_WIDEST]):
                self._take(f"{name}.{index}", one)
        elif value and len(value) <= _WIDEST:
            numbers = [np.nan if one is None else one for one in value] if type(None) in kinds else value
            self._put(self._lists, name, numbers, len(value))

    def _put(self, columns: dict[str, _Column], name: str, numbers: Sequence[float], width: int) -> None:
        column = columns.get(name)
        if column is None:
            column = columns[name] = _Column(width)
            self._width += width
            if excess := RECORDING_NUMBERS.excess((self.rows + 1) * self._width):
                raise ExcessError(f"it {excess}")
        try:
            taken = column.width != width or column.put(self.rows, numbers)  # a list of another length is missing
        except OverflowError:
            raise TableError(self._path, f"{self._place}: {name} is beyond all numbers") from None
        if not taken:
            raise TableError(self._path, f"{self._place}: has {quoted(name)} more than once")

    def numbers(self) -> dict[str, FloatArray]:
        """Return the columns, without lists of many lengths and names that have texts; these count as texts.

        Raises:
            TableError: if almost all of a list's lengths are the same; names the first other one.
        """
        uneven = tuple(f"{name}." for name in self._uneven())
        found: dict[str, FloatArray] = {}
        for name, column in chain(self._single.items(), self._lists.items()):
            column.put(self.rows, ())
            wide = np.frombuffer(column.numbers, dtype=np.float64).reshape(self.rows, column.width)
            names = [name] if name in self._single else [f"{name}.{index}" for index in range(column.width)]
            for index, label in enumerate(names):
                if label in self.texts or label.startswith(uneven):
                    self.texts[label] = ""
                elif label in found and not (np.isnan(found[label]) | np.isnan(wide[:, index])).all():
                    raise TableError(self._path, f"has {quoted(label)} more than once")
                else:
                    before = found.get(label, wide[:, index])
                    found[label] = np.where(np.isnan(before), wide[:, index], before)
        return found

    def _uneven(self) -> Iterator[str]:
        for name, lengths in self._lengths.items():
            (usual, count), *others = lengths.most_common()
            if others and usual and count >= _ALIKE * lengths.total():
                length, where = others[0][0], self._first[name, others[0][0]]
                raise TableError(
                    self._path, f"{where}: {name} has a list of {length} values; {count} other rows have {usual}"
                )
            if others or usual > _WIDEST:
                yield name


def _table(path: Path, form: str, rows: Iterable[tuple[str, Any]], notes: list[str]) -> NumericTable:
    found, places = _Columns(path), array("q")
    for place, row in rows:
        found.add(place, row)
        places.append(int(place.split()[1]))
    if not found.rows:
        raise TableError(path, f"has no rows. {_ALLOWED}")
    columns = _with_stamps(found.numbers())
    lines = np.frombuffer(places, dtype=np.int64) if form == "JSON lines" else None
    return NumericTable(path, form, columns, {}, lines, found.texts, tuple(notes))


def _with_stamps(columns: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return columns with one time in s for each pair of a whole number of s and of ns."""
    found = dict(columns)
    for seconds, rest in _STAMPS:
        for name in columns:
            stem = name.removesuffix(seconds)
            if stem != name and stem + rest in found and stem not in found:
                found = {stem: found.pop(name) + 1e-9 * found.pop(stem + rest), **found}
    return found
