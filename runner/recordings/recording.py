"""Recording: signals of an arm over time, read from a file and checked."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.tables import NumericTable
from runner.recordings.clock import Clock, longest_step, read_clock, without_repeats
from runner.recordings.columns_map import AMPERE, ColumnsMap, Factor, Holds, MappedColumn, Side, Signal, stacked
from runner.recordings.files import read_log
from runner.recordings.smoothing import CUTOFF, evenly
from runner.schema.model import LARGEST

FEWEST_ROWS = 50
LONGEST_FILLED = 1.0 / CUTOFF
"""Longest gap that may be filled, in s: an arm may have moved there and back in a longer one."""

_DECIMALS = 1e-6  # relative error of differences of decimal times
_OTHER_RATE = 0.01  # relative difference from the rate that is said
_NEW = 0.5  # of the rows that are left out, from which on a column does not repeat in them
_NEAR_A_TURN = 0.25  # of a turn: what a step from one row to the next may differ from it, if it is a jump


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
        holds: What the torques are.
        side: The side of the gears on which torques are measured.
        currents: Torques that are currents times a constant.
        notes: Messages for a user: what was done to rows and columns.
    """

    path: Path
    t: FloatArray
    signals: Mapping[Signal, FloatArray]
    columns: Mapping[Signal, str]
    units: Mapping[str, Factor]
    held: bool
    filled: Sequence[float]
    holds: Holds = "torque"
    side: Side = "motor"
    currents: Sequence[Signal] = ()
    notes: Sequence[str] = ()

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

    def of_kind(self, kind: str) -> list[Signal]:
        """Return the signals of a kind."""
        return [signal for signal in self.signals if signal.kind == kind]

    def positions(self, joints: Sequence[str]) -> FloatArray | None:
        """Return the positions of all joints, shape (N, nq); None where one is not recorded."""
        return stacked(self.signals, [Signal("position", joint) for joint in joints])

    def torque_at(self, signal: Signal, times: FloatArray) -> FloatArray:
        """Return a torque at other times, along straight lines between the middles of the times in which it acts."""
        return np.asarray(np.interp(times, self.t + self.torque_shift, self.signals[signal]))


def read_recording(path: Path, said: ColumnsMap, factors: Mapping[str, Factor], fill_gaps: float = 0.0) -> Recording:
    """Return the signals of a recording.

    Args:
        path: The log; see read_log.
        said: What its columns are.
        factors: What makes each column SI, by its name.
        fill_gaps: Longest gap that is filled, in s; 0 for none.

    Raises:
        RunnerError: if it cannot be read, lacks a column, has a cell without a number or with one beyond reason, gaps
            in time or another rate than is said; names the line.
    """
    check_gaps(fill_gaps)
    wanted = [*([said.time.column] if said.time is not None else []), *said.columns]
    return to_recording(read_log(path, wanted, said.topic, said.episode), said, factors, fill_gaps)


def check_gaps(fill_gaps: float) -> None:
    """Check the longest gap that may be filled, in s.

    Raises:
        RunnerError: if an arm may have moved there and back in it.
    """
    if not 0.0 <= fill_gaps <= LONGEST_FILLED:
        raise RunnerError(f"gaps of up to {LONGEST_FILLED:g} s can be filled; found {fill_gaps:g} s")


def to_recording(
    table: NumericTable, said: ColumnsMap, factors: Mapping[str, Factor], fill_gaps: float = 0.0
) -> Recording:
    """Return the signals in a table; see read_recording."""
    path, fill_gaps = table.path, fill_gaps * (1.0 + _DECIMALS)
    time = None if said.time is None else said.time.column
    table = table.of([*([] if time is None else [time]), *said.columns], time)
    if len(table) < FEWEST_ROWS:
        raise RunnerError(f"{path}: too short: {len(table)} rows; needed: {FEWEST_ROWS} or more")
    every = _clock(table, said, factors)
    clock = _without_repeats(table, said, every)
    t, notes = clock.t, [*table.notes, *clock.notes]
    if len(t) < FEWEST_ROWS:
        raise RunnerError(f"{path}: too short: {len(t)} rows at different times; needed: {FEWEST_ROWS} or more")
    filled = _gaps(table, "rows are", clock, np.arange(len(t)), np.diff(t) > longest_step(_period(t)), fill_gaps)
    own: dict[Signal, FloatArray] = {}
    for name, column in said.columns.items():
        numbers, jumps = _unwrapped(_of_rows(table.columns[name], column, said, every, clock), column, factors[name])
        if jumps:
            notes.append(f"{name} jumps by a turn {jumps} times: the jumps are removed")
        values = _in_si(table, name, numbers - column.zero, factors[name], clock)
        own[column.signal], gaps = _filled(table, name, clock, values, column.signal, fill_gaps)
        filled += gaps
    signals = {
        column.signal: own[column.signal]
        + sum(factor * own[Signal(column.signal.kind, joint)] for joint, factor in column.coupling.items())
        for column in said.columns.values()
    }
    columns = {column.signal: name for name, column in said.columns.items()}
    currents = [column.signal for column in said.columns.values() if column.unit == AMPERE]
    return Recording(
        path, t, signals, columns, dict(factors), said.held, filled, said.holds, said.side, currents, notes
    )


def _period(t: FloatArray) -> float:
    return float(np.median(np.diff(t)))


def _clock(table: NumericTable, said: ColumnsMap, factors: Mapping[str, Factor]) -> Clock:
    if said.time is None:
        assert said.rate is not None  # noqa: S101 - the map has one of both
        return Clock(np.arange(len(table)) / said.rate, np.arange(len(table)), [])
    # From the first row on: a clock that began in 1970 leaves too few digits for times between rows.
    stamps = table.columns[said.time.column]
    rows = np.arange(len(stamps))
    first = stamps[~np.isnan(stamps)][:1]
    t = _in_si(table, said.time.column, stamps - first, factors[said.time.column], Clock(stamps, rows, []))
    try:
        clock = read_clock(t, table.place)
    except RunnerError as error:
        raise RunnerError(f"{table.path}: {error}") from None
    steps = np.diff(clock.t)
    usual = [float(np.median(steps)), float(steps.mean())]
    if said.rate is not None and min(abs(said.rate * period - 1.0) for period in usual) > _OTHER_RATE:
        raise RunnerError(
            f"{table.path}: its rows come at {1.0 / usual[0]:.4g} Hz by the column of time in {said.time.unit}, and "
            f"rate says {said.rate:.4g} Hz; leave out rate, or correct the unit of the time"
        )
    return clock


def _without_repeats(table: NumericTable, said: ColumnsMap, every: Clock) -> Clock:
    """Leave out rows that repeat positions in motion, if there are many; the note names what else they hold."""
    moving = [name for name, column in said.columns.items() if column.signal.kind in ("position", "tip")]
    if not moving:
        return every
    clock = without_repeats(every, np.column_stack([table.columns[name][every.rows] for name in moving]))
    if clock is every:
        return clock
    new = {column.signal.kind for name, column in said.columns.items() if _is_new(table.columns[name], every, clock)}
    also = [word for kind, word in (("reference", "commands"), ("torque", "torques")) if kind in new]
    note = f"{clock.notes[-1]}, with {' and '.join(also)} that do not repeat" if also else clock.notes[-1]
    return clock._replace(notes=[*clock.notes[:-1], note])


def _is_new(numbers: FloatArray, every: Clock, clock: Clock) -> bool:
    """Return whether a column changes in the rows that are left out."""
    left_out = ~np.isin(every.rows, clock.rows)
    return bool(np.mean(np.diff(numbers[every.rows])[left_out[1:]] != 0.0) > _NEW) if left_out.any() else False


def _of_rows(numbers: FloatArray, column: MappedColumn, said: ColumnsMap, every: Clock, clock: Clock) -> FloatArray:
    """Return a column in the rows that stay.

    A held torque that does not repeat acts only up to the next row of the log: it is taken from the middle of the time
    to the next row that stays.
    """
    values = numbers[clock.rows]
    if column.signal.kind != "torque" or not said.held or not _is_new(numbers, every, clock):
        return values
    middle = np.interp(clock.t + 0.5 * (_period(clock.t) - _period(every.t)), every.t, numbers[every.rows])
    return np.where(np.isnan(values), np.nan, middle)


def _unwrapped(numbers: FloatArray, column: MappedColumn, factor: Factor) -> tuple[FloatArray, int]:
    """Return a column without its jumps by a turn, and their number."""
    if column.signal.kind not in ("position", "reference") or (column.wrap is None and factor.unit != "rad"):
        return numbers, 0
    turn = column.wrap or 2.0 * np.pi / abs(factor.factor)
    known = np.flatnonzero(~np.isnan(numbers))
    steps = np.diff(numbers[known])
    turns = np.where(np.abs(np.abs(steps) - turn) < _NEAR_A_TURN * turn, np.sign(steps), 0.0)
    going_on = numbers.copy()
    going_on[known[1:]] -= turn * np.cumsum(turns)
    return going_on, int(np.sum(turns != 0.0))


def _in_si(table: NumericTable, name: str, numbers: FloatArray, factor: Factor, clock: Clock) -> FloatArray:
    """Return a column in SI units, none of whose numbers is beyond reason."""
    with np.errstate(over="ignore"):
        values: FloatArray = numbers * factor.factor
    beyond = np.abs(values) > LARGEST
    if beyond.any():
        row = int(np.argmax(beyond))
        where = f"{table.path}: {table.place(int(clock.rows[row]))}: {name} is {values[row]:.4g} {factor.unit}"
        raise RunnerError(f"{where}{_and_more(int(beyond.sum()))}; allowed: up to {LARGEST:g} in magnitude")
    return values


def _filled(
    table: NumericTable, name: str, clock: Clock, values: FloatArray, signal: Signal, fill_gaps: float
) -> tuple[FloatArray, list[float]]:
    """Return a signal without gaps, and the gaps that it had, in s."""
    t, missing = clock.t, np.isnan(values)
    if missing[[0, -1]].any():
        first = table.place(int(clock.rows[int(np.argmax(missing))]))
        where = f"{first}: {name} is missing, in {missing.sum()} of {len(t)} rows"
        raise RunnerError(f"{table.path}: {where} and at an end; leave out the column, or cut the recording")
    if not missing.any():
        return values, []
    kept = np.flatnonzero(~missing)
    gaps = _gaps(table, f"{name} is", clock, kept, np.diff(kept) > 1, fill_gaps)
    straight = signal.kind == "torque"
    return np.interp(t, t[kept], values[kept]) if straight else evenly(t[kept], values[kept], t), gaps


def _gaps(
    table: NumericTable, what: str, clock: Clock, kept: NDArray[np.intp], wide: NDArray[np.bool_], fill_gaps: float
) -> list[float]:
    """Return the lengths of the wide steps between the kept rows, in s, if none exceeds the filled length."""
    steps = np.diff(clock.t[kept])
    longer = np.flatnonzero(wide & (steps > fill_gaps))
    if len(longer):
        first, longest = int(longer[0]), float(steps[longer].max())
        remedy = "cut the recording to a part without gaps"
        if longest <= LONGEST_FILLED:
            needed = np.ceil(1e3 * longest * (1.0 - _DECIMALS))
            remedy = f"`--fill-gaps {needed:.0f}ms` fills the gaps; or {remedy}"
        raise RunnerError(
            f"{table.path}: {table.place(int(clock.rows[kept[first] + 1]))}: {what} missing for {steps[first]:.4g} s"
            f"{_and_more(len(longer))}, where rows are {_period(clock.t):.4g} s apart; {remedy}"
        )
    return [float(step) for step in steps[wide]]


def _and_more(count: int) -> str:
    return f" (and {count - 1} more like this)" if count > 1 else ""
