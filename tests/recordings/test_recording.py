"""Recordings read from CSV against arrays by hand: units, rates and times."""

import numpy as np
import pytest

from runner.errors import RunnerError
from runner.limits import Limit
from runner.recordings import csv_columns
from runner.recordings.columns_map import ColumnsMap, Factor, Signal
from runner.recordings.recording import read_recording

FACTORS = {"t": Factor(1e-3, "s"), "a": Factor(2.0, "rad")}
Q1 = Signal("position", "q1")


def said(rate=None, time=True):
    values = {"columns": {"a": {"joint": "q1", "unit": "rad"}}, "rate": rate}
    return ColumnsMap(**values, time={"column": "t", "unit": "ms"} if time else None)


def write(tmp_path, lines):
    path = tmp_path / "recording.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def rows(times):
    return ["note,t,a", *(f"x,{t},{0.5 * t}" for t in times)]


def test_columns_become_si_and_others_are_not_read(tmp_path):
    found = read_recording(write(tmp_path, rows(range(0, 200, 2))), said(), FACTORS)
    assert found.t == pytest.approx(np.arange(100) * 2e-3)
    assert found.signals[Q1] == pytest.approx(np.arange(100) * 2.0)
    assert found.period == pytest.approx(2e-3)
    assert found.duration == pytest.approx(0.198)


def test_rows_at_a_rate(tmp_path):
    found = read_recording(write(tmp_path, rows(range(60))), said(rate=50.0, time=False), FACTORS)
    assert found.t == pytest.approx(np.arange(60) * 0.02)


def test_time_that_jitters_is_taken(tmp_path):
    times = np.arange(100) * 2.0 + 0.3 * np.sin(np.arange(100))
    assert read_recording(write(tmp_path, rows(times)), said(rate=500.0), FACTORS).t == pytest.approx(1e-3 * times)


@pytest.mark.parametrize(
    ("times", "rate", "wanted"),
    [
        ([*range(60), *range(200, 240)], None, r"line 62: a gap of 0.141 s in time, where rows are 0.001 s apart; cut"),
        (
            [*range(60), *range(80, 120)],
            None,
            r"line 62: a gap of 0.021 s in time, where rows are 0.001 s apart; `--fill-gaps 21ms` fills",
        ),
        ([*range(60), 59, *range(60, 90)], None, r"line 62: the time is 0.059 s after 0.059 s; time must increase"),
        ([*range(60), 30, *range(60, 90)], None, r"line 62: the time is 0.03 s after 0.059 s; time must increase"),
        (range(100), 500.0, r"its rows come at 1000 Hz by the column of time in ms, and rate says 500 Hz"),
        (range(49), None, r"too short: 49 rows; needed: 50 or more"),
    ],
)
def test_times_that_do_not_fit(tmp_path, times, rate, wanted):
    with pytest.raises(RunnerError, match=wanted):
        read_recording(write(tmp_path, rows(times)), said(rate), FACTORS)


@pytest.mark.parametrize(
    ("lines", "wanted"),
    [
        (["t,b", "0,1"], r"has no column 'a'; its columns: t, b"),
        (
            ["time,a_1", "0,1"],
            r"has no column 't' \(did you mean time\?\)|'t', 'a' \(did you mean a_1\?\); its columns: time, a_1",
        ),
        (["t,a,a", "0,1,2"], r"line 1 has the column 'a' more than once"),
        (
            ["t,a", "0,1", "1", "2,x", "3,", "4,nan"],
            r"line 3: 1 cells for 2 columns; line 4: a is 'x'.*line 5: a is mis",
        ),
        (["t,a", *["0,-"] * 8], r"line 6: a is '-'; needed: a finite number; 3 more problems like these"),
        ([], r"has no column 't', 'a'; its columns: none"),
    ],
)
def test_cells_that_do_not_fit(tmp_path, lines, wanted):
    with pytest.raises(RunnerError, match=wanted):
        read_recording(write(tmp_path, lines), said(), FACTORS)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(RunnerError, match=r"cannot read .*none.csv"):
        read_recording(tmp_path / "none.csv", said(), FACTORS)


def test_rows_are_counted_while_they_are_read(tmp_path, monkeypatch):
    path = write(tmp_path, rows(range(60)))
    monkeypatch.setattr(csv_columns, "RECORDING_ROWS", Limit(61, "rows"))
    assert len(read_recording(path, said(), FACTORS).t) == 60
    monkeypatch.setattr(csv_columns, "RECORDING_ROWS", Limit(60, "rows"))
    with pytest.raises(RunnerError, match=r"cannot read .*recording.csv: it has 61 rows; allowed: up to 60"):
        read_recording(path, said(), FACTORS)


@pytest.mark.parametrize("row", ["," * 100_001, '"\n",' * 60_000])
def test_a_row_without_end_is_not_kept(tmp_path, row):
    with pytest.raises(RunnerError, match="characters in a row; allowed: up to 100,000"):
        read_recording(write(tmp_path, ["t,a", row]), said(), FACTORS)


def test_a_recording_of_a_terabyte_is_not_read(tmp_path):
    path = write(tmp_path, rows(range(60)))
    with path.open("r+b") as file:
        file.truncate(10**12)
    with pytest.raises(RunnerError, match="has 1,000,000,000,000 bytes; allowed: up to 100,000,000"):
        read_recording(path, said(), FACTORS)


def test_problems_beyond_the_first_are_counted_and_empty_lines_at_the_end_are_none(tmp_path):
    assert len(read_recording(write(tmp_path, [*rows(range(60)), "", ",,"]), said(), FACTORS).t) == 60
    with pytest.raises(RunnerError, match=r"line 62: 0 cells for 3 columns; line 63: t is '-'"):
        read_recording(write(tmp_path, [*rows(range(60)), "", "x,-,1", ""]), said(), FACTORS)
