"""A recording: signals of an arm over time, read from CSV and checked, with the line of what is wrong."""

import csv
import math
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from runner.errors import RunnerError, nearest
from runner.limits import RECORDING, RECORDING_ROW, RECORDING_ROWS, ExcessError
from runner.recordings.columns_map import ColumnsMap, Factor, Signal
from runner.texts import few, quoted

FloatArray = NDArray[np.float64]

FEWEST_ROWS = 50
_MOST_TOLD = 5  # problems of one file
_GAP = 1.5  # times the usual time between two rows
_OTHER_RATE = 0.01  # relative difference from the rate that is said


@dataclass(frozen=True)
class Recording:
    """Signals of an arm, in SI units.

    Attributes:
        path: Its file.
        t: Times, shape (N,), in s; they run forward without a gap.
        signals: Each signal, shape (N,), in rad, m, N m or N.
        columns: The column that each signal stands in.
        units: The unit that each column is said to have.
    """

    path: Path
    t: FloatArray
    signals: Mapping[Signal, FloatArray]
    columns: Mapping[Signal, str]
    units: Mapping[str, Factor]

    @property
    def period(self) -> float:
        """Usual time between two rows, in s."""
        return float(np.median(np.diff(self.t)))

    @property
    def duration(self) -> float:
        """Time from the first row to the last, in s."""
        return float(self.t[-1] - self.t[0])

    def of_joints(self, kind: str, joints: Sequence[str]) -> FloatArray | None:
        """Return the positions or torques of all joints, shape (N, nq); None where one is not recorded."""
        wanted = [self.signals.get(Signal("torque" if kind == "torque" else "position", joint)) for joint in joints]
        found = [signal for signal in wanted if signal is not None]
        return np.column_stack(found) if len(found) == len(wanted) else None


def read_recording(path: Path, said: ColumnsMap, factors: Mapping[str, Factor]) -> Recording:
    """Return the signals of a recording.

    Args:
        path: The file: CSV, the names of its columns in the first line.
        said: What its columns are.
        factors: What makes each column SI, by its name.

    Raises:
        RunnerError: if it cannot be read, lacks a column, has a cell without a number, gaps in time or another rate
            than is said; names the line.
    """
    wanted = [*([said.time.column] if said.time is not None else []), *said.columns]
    numbers = _read_columns(path, wanted)
    rows = len(numbers[wanted[0]])
    if rows < FEWEST_ROWS:
        raise RunnerError(f"{path}: too short: {rows} rows; needed: {FEWEST_ROWS} or more")
    if said.time is None:
        assert said.rate is not None  # noqa: S101 - the map has one of both
        t = np.arange(rows) / said.rate
    else:
        t = numbers[said.time.column] * factors[said.time.column].factor
        _check_time(path, t, said)
    return Recording(
        path,
        t,
        {column.signal: numbers[name] * factors[name].factor for name, column in said.columns.items()},
        {column.signal: name for name, column in said.columns.items()},
        dict(factors),
    )


def _read_columns(path: Path, wanted: Sequence[str]) -> dict[str, FloatArray]:
    try:
        if excess := RECORDING.excess(path.stat().st_size):
            raise ExcessError(f"it {excess}")
        with path.open(encoding="utf-8-sig", newline="") as file:
            return _columns_of(path, _rows(file), wanted)
    except (OSError, ExcessError, UnicodeDecodeError, csv.Error) as error:
        raise RunnerError(f"cannot read {path}: {error}") from error


def _rows(file: TextIO) -> Iterator[list[str]]:
    """Yield the rows of a CSV file, none longer than allowed: quotes can join all lines to one."""
    held = 0

    def lines() -> Iterator[str]:
        nonlocal held
        for number, line in enumerate(file, start=1):
            held += len(line)
            if excess := RECORDING_ROWS.excess(number) or RECORDING_ROW.excess(held):
                raise ExcessError(f"it {excess}")
            yield line

    for row in csv.reader(lines()):
        held = 0
        yield row


def _columns_of(path: Path, rows: Iterator[list[str]], wanted: Sequence[str]) -> dict[str, FloatArray]:
    names = [name.strip() for name in next(rows, [])]
    twice = [name for name in dict.fromkeys(names) if name in wanted and names.count(name) > 1]
    problems = [f"line 1 has the column {quoted(name)} more than once" for name in twice]
    missing = [f"{quoted(name)}{nearest(name, names)}" for name in wanted if name not in names]
    if missing:
        problems.append(f"has no column {few(missing)}; its columns: {few(names) or 'none'}")
    if problems:
        raise _refused(path, problems)
    found = {name: array("d") for name in wanted}
    places, told, empty = [(names.index(name), name) for name in wanted], 0, []
    for line, cells in enumerate(rows, start=2):
        if not any(cell.strip() for cell in cells):
            empty.append(f"line {line}: {len(cells)} cells for {len(names)} columns")
            continue
        wrong, empty = empty, []  # at the end of the file they do no harm
        if len(cells) != len(names):
            wrong.append(f"line {line}: {len(cells)} cells for {len(names)} columns")
        for place, name in places if len(cells) == len(names) else ():
            found[name].append(_number(cells[place]))
            if math.isnan(found[name][-1]):
                text = cells[place].strip()
                wrong.append(f"line {line}: {name} is {quoted(text) if text else 'missing'}; needed: a finite number")
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


def _check_time(path: Path, t: FloatArray, said: ColumnsMap) -> None:
    steps = np.diff(t)
    back = np.flatnonzero(steps <= 0.0)
    if len(back):
        row = int(back[0])
        raise RunnerError(
            f"{path}: line {row + 3}: the time is {t[row + 1]:g} s after {t[row]:g} s; time must increase from row to "
            f"row{_and_more(len(back))}"
        )
    period = float(np.median(steps))
    if said.rate is not None and abs(said.rate * period - 1.0) > _OTHER_RATE:
        unit = said.time.unit if said.time is not None else ""
        raise RunnerError(
            f"{path}: its rows come at {1.0 / period:.4g} Hz by the column of time in {unit}, and rate says "
            f"{said.rate:.4g} Hz; leave out rate, or mend the unit of the time"
        )
    gaps = np.flatnonzero(steps > _GAP * period)
    if len(gaps):
        row = int(gaps[0])
        raise RunnerError(
            f"{path}: line {row + 3}: a gap of {steps[row]:.4g} s in time, where rows are {period:.4g} s apart"
            f"{_and_more(len(gaps))}; cut the recording to a part without gaps"
        )


def _and_more(count: int) -> str:
    return f" (and {count - 1} more lines like this)" if count > 1 else ""


def _refused(path: Path, problems: Sequence[str], count: int = 0) -> RunnerError:
    more = max(count, len(problems)) - _MOST_TOLD
    told = [*problems[:_MOST_TOLD], *([f"{more} more problems like these"] if more > 0 else [])]
    return RunnerError(f"{path}: {'; '.join(told)}")
