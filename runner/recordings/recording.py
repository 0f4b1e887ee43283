"""Recording: signals of an arm over time, read from a file and checked."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.recordings import BAGS, is_bag
from runner.recordings.columns_map import ColumnsMap, Factor, Signal, stacked
from runner.recordings.files import read_bag_columns, read_csv_columns
from runner.recordings.smoothing import CUTOFF, evenly
from runner.schema.model import LARGEST

FEWEST_ROWS = 50
LONGEST_FILLED = 1.0 / CUTOFF
"""Longest gap that may be filled, in s: an arm may have moved there and back in a longer one."""

_DECIMALS = 1e-6  # relative error of differences of decimal times
_GAP = 1.5  # times the usual time between two rows
_OTHER_RATE = 0.01  # relative difference from the rate that is said


@dataclass(frozen=True)
class Recording:
    """Signals of an arm, in SI units.

    Attributes:
        path: Its file.
        t: Times since its first row, shape (N,), in s.
        signals: Each signal, shape (N,), in rad, m, N m or N.
        columns: The column that each signal stands in.
        units: The unit that each column is said to have.
        held: Whether torques act from their row to the next one.
        filled: Gaps that were filled, in s.
    """

    path: Path
    t: FloatArray
    signals: Mapping[Signal, FloatArray]
    columns: Mapping[Signal, str]
    units: Mapping[str, Factor]
    held: bool
    filled: Sequence[float]

    @property
    def period(self) -> float:
        """Usual time between two rows, in s."""
        return float(np.median(np.diff(self.t)))

    @property
    def duration(self) -> float:
        """Time from the first row to the last, in s."""
        return float(self.t[-1])

    @property
    def torque_shift(self) -> float:
        """Time from a row to the middle of the time in which its torque acts, in s."""
        return 0.5 * self.period if self.held else 0.0

    def positions(self, joints: Sequence[str]) -> FloatArray | None:
        """Return the positions of all joints, shape (N, nq); None where one is not recorded."""
        return stacked(self.signals, [Signal("position", joint) for joint in joints])

    def torque_at(self, signal: Signal, times: FloatArray) -> FloatArray:
        """Return a torque at other times, along straight lines between the middles of the times in which it acts."""
        return np.asarray(np.interp(times, self.t + self.torque_shift, self.signals[signal]))


def read_recording(path: Path, said: ColumnsMap, factors: Mapping[str, Factor], fill_gaps: float = 0.0) -> Recording:
    """Return the signals of a recording.

    Args:
        path: The file: CSV, the names of its columns in the first line; or a ROS bag, see ros_bag.
        said: What its columns are.
        factors: What makes each column SI, by its name.
        fill_gaps: Longest gap that is filled, in s; 0 for none.

    Raises:
        RunnerError: if it cannot be read, lacks a column, has a cell without a number or with one beyond reason, gaps
            in time or another rate than is said; names the line.
    """
    if not 0.0 <= fill_gaps <= LONGEST_FILLED:
        raise RunnerError(f"gaps of up to {LONGEST_FILLED:g} s can be filled; found {fill_gaps:g} s")
    fill_gaps *= 1.0 + _DECIMALS
    wanted = [*([said.time.column] if said.time is not None else []), *said.columns]
    if is_bag(path):
        numbers = read_bag_columns(path, said.topic, wanted)
    elif said.topic is not None:
        raise RunnerError(f"{path}: topic: is for ROS bags ({', '.join(BAGS)})")
    else:
        numbers = read_csv_columns(path, wanted)
    rows = len(numbers[wanted[0]])
    if rows < FEWEST_ROWS:
        raise RunnerError(f"{path}: too short: {rows} rows; needed: {FEWEST_ROWS} or more")
    filled: list[float] = []
    if said.time is None:
        assert said.rate is not None  # noqa: S101 - the map has one of both
        t = np.arange(rows) / said.rate
    else:
        # From the first row on: a clock that began in 1970 leaves too few digits for times between rows.
        stamps = numbers[said.time.column]
        t = _in_si(path, said.time.column, stamps - stamps[0], factors[said.time.column])
        filled = _check_time(path, t, said, fill_gaps)
    signals = {}
    for name, column in said.columns.items():
        values = _in_si(path, name, numbers[name], factors[name])
        signals[column.signal], gaps = _filled(path, name, t, values, column.signal, fill_gaps)
        filled += gaps
    columns = {column.signal: name for name, column in said.columns.items()}
    return Recording(path, t, signals, columns, dict(factors), said.torque == "held", filled)


def _in_si(path: Path, name: str, numbers: FloatArray, factor: Factor) -> FloatArray:
    """Return a column in SI units, none of whose numbers is beyond reason."""
    with np.errstate(over="ignore"):
        values: FloatArray = numbers * factor.factor
    beyond = np.abs(values) > LARGEST
    if beyond.any():
        row = int(np.argmax(beyond))
        where = f"{path}: {_place(path, row)}: {name} is {values[row]:.4g} {factor.unit}"
        raise RunnerError(f"{where}{_and_more(int(beyond.sum()))}; allowed: up to {LARGEST:g} in magnitude")
    return values


def _check_time(path: Path, t: FloatArray, said: ColumnsMap, fill_gaps: float) -> list[float]:
    """Return the gaps in time that are to be filled, in s."""
    steps = np.diff(t)
    back = np.flatnonzero(~(steps > 0.0))
    if len(back):
        row = int(back[0])
        raise RunnerError(
            f"{path}: {_place(path, row + 1)}: the time is {t[row + 1]:g} s after {t[row]:g} s; time must increase "
            f"from row to row{_and_more(len(back))}"
        )
    period = float(np.median(steps))
    if said.rate is not None and abs(said.rate * period - 1.0) > _OTHER_RATE:
        unit = said.time.unit if said.time is not None else ""
        raise RunnerError(
            f"{path}: its rows come at {1.0 / period:.4g} Hz by the column of time in {unit}, and rate says "
            f"{said.rate:.4g} Hz; leave out rate, or correct the unit of the time"
        )
    return _gaps(path, "rows are", t, np.arange(len(t)), steps > _GAP * period, fill_gaps)


def _filled(
    path: Path, name: str, t: FloatArray, values: FloatArray, signal: Signal, fill_gaps: float
) -> tuple[FloatArray, list[float]]:
    """Return a signal without gaps, and the gaps that it had, in s."""
    missing = np.isnan(values)
    if missing[[0, -1]].any():
        where = f"{_place(path, int(np.argmax(missing)))}: {name} is missing, in {missing.sum()} of {len(t)} rows"
        raise RunnerError(f"{path}: {where} and at an end; leave out the column, or cut the recording")
    if not missing.any():
        return values, []
    kept = np.flatnonzero(~missing)
    gaps = _gaps(path, f"{name} is", t, kept, np.diff(kept) > 1, fill_gaps)
    straight = signal.kind == "torque"
    return np.interp(t, t[kept], values[kept]) if straight else evenly(t[kept], values[kept], t), gaps


def _gaps(
    path: Path, what: str, t: FloatArray, kept: NDArray[np.intp], wide: NDArray[np.bool_], fill_gaps: float
) -> list[float]:
    """Return the lengths of the wide steps between the kept rows, in s, if none exceeds the filled length."""
    steps = np.diff(t[kept])
    longer = np.flatnonzero(wide & (steps > fill_gaps))
    if len(longer):
        first, longest = int(longer[0]), float(steps[longer].max())
        remedy = "cut the recording to a part without gaps"
        if longest <= LONGEST_FILLED:
            needed = np.ceil(1e3 * longest * (1.0 - _DECIMALS))
            remedy = f"`--fill-gaps {needed:.0f}ms` fills the gaps; or {remedy}"
        raise RunnerError(
            f"{path}: {_place(path, int(kept[first]) + 1)}: {what} missing for {steps[first]:.4g} s"
            f"{_and_more(len(longer))}, where rows are {np.median(np.diff(t)):.4g} s apart; {remedy}"
        )
    return [float(step) for step in steps[wide]]


def _place(path: Path, row: int) -> str:
    """Return the line of a row of numbers; the first line of a CSV file names its columns."""
    return f"row {row + 1}" if is_bag(path) else f"line {row + 2}"


def _and_more(count: int) -> str:
    return f" (and {count - 1} more like this)" if count > 1 else ""
