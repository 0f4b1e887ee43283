"""Recordings read from CSV against arrays by hand: units, rates and times."""

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.base.limits import Limit
from runner.recordings import files
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
    return ["note,t,a", *(f"x,{t},{0.5 * (t or 0)}" for t in times)]


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
        (
            [*range(60), *range(200, 240)],
            None,
            r"line 62: rows are missing for 0.141 s, where rows are 0.001 s apart; cut",
        ),
        (
            [*range(60), *range(80, 120)],
            None,
            r"line 62: rows are missing for 0.021 s, where rows are 0.001 s apart; `--fill-gaps 21ms` fills",
        ),
        ([*range(30), "", *range(31, 60)], None, r"line 32: the time is nan s after 0.029 s; time must increase"),
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
            ["t,a", "0,1", "1", "2,x", "3,inf"],
            r"line 3: 1 cells for 2 columns; line 4: a is 'x'.*line 5: a is 'inf'; needed: a finite number",
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
    monkeypatch.setattr(files, "RECORDING_ROWS", Limit(61, "rows"))
    assert len(read_recording(path, said(), FACTORS).t) == 60
    monkeypatch.setattr(files, "RECORDING_ROWS", Limit(60, "rows"))
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


@pytest.mark.parametrize(("separator", "point"), [(";", ","), (";", "."), ("\t", ","), (",", ".")])
def test_cells_are_separated_by_what_separates_the_names(tmp_path, separator, point):
    lines = [f"x{separator}{t}{point}0{separator}{t}{point}5" for t in range(60)]
    found = read_recording(write(tmp_path, [separator.join(["note", "t", "a"]), *lines]), said(), FACTORS)
    assert found.t == pytest.approx(np.arange(60) * 1e-3)
    assert found.signals[Q1] == pytest.approx(2.0 * (np.arange(60) + 0.5))


def test_stamps_count_from_the_first_row_and_torques_from_the_middle_of_theirs(tmp_path):
    path = write(tmp_path, ["t,a", *(f"{1_700_000_000_000 + 4 * t},{t}" for t in range(60))])
    both = ColumnsMap(time={"column": "t", "unit": "ms"}, columns={"a": {"torque": "q1", "unit": "N m"}})
    found = read_recording(path, both, {"t": Factor(1e-3, "s"), "a": Factor(1.0, "N m")})
    assert found.t == pytest.approx(4e-3 * np.arange(60), abs=1e-9)
    of_q1 = Signal("torque", "q1")
    assert found.torque_at(of_q1, np.array([0.006, 0.008])) == pytest.approx([1.0, 1.5])
    instant = read_recording(path, both.model_copy(update={"torque": "instant"}), {**found.units})
    assert instant.torque_at(of_q1, np.array([0.006, 0.008])) == pytest.approx([1.5, 2.0])


def test_gaps_are_filled_up_to_what_is_asked_for(tmp_path):
    times = [t for t in range(100) if not 40 <= t < 44]
    lines = ["t,a", *(f"{t},{'NaN' if t in (20, 21) else np.sin(0.05 * t)}" for t in times)]
    found = read_recording(write(tmp_path, lines), said(), FACTORS, fill_gaps=0.005)
    assert found.filled == pytest.approx([0.005, 0.003])
    assert found.signals[Q1] == pytest.approx(2.0 * np.sin(0.05 * np.array(times)), abs=1e-5)
    with pytest.raises(RunnerError, match=r"line 42: rows are missing for 0.005 s.*`--fill-gaps 5ms` fills"):
        read_recording(write(tmp_path, lines), said(), FACTORS, fill_gaps=0.004)
    without = write(tmp_path, ["t,a", *(f"{t},{'' if 20 <= t < 25 else t}" for t in range(60))])
    for fill_gaps in (0.0, 0.004):
        with pytest.raises(RunnerError, match=r"line 22: a is missing for 0.006 s, .*; `--fill-gaps 6ms` fills"):
            read_recording(without, said(), FACTORS, fill_gaps)


@pytest.mark.parametrize(
    ("gone", "wanted"),
    [
        (range(5), "line 2: a is missing, in 5 of 60 rows and at an end"),
        (range(60), "line 2: a is missing, in 60 of 60 rows and at an end; leave"),
    ],
)
def test_gaps_at_an_end_and_empty_columns_are_not_filled(tmp_path, gone, wanted):
    lines = ["t,a", *(f"{t},{'' if t in gone else t}" for t in range(60))]
    with pytest.raises(RunnerError, match=wanted):
        read_recording(write(tmp_path, lines), said(), FACTORS, fill_gaps=0.02)


@pytest.mark.parametrize(("cell", "told"), [("1e18", "2e\\+18"), ("-1e308", "-inf"), ("6e11", "1.2e\\+12")])
def test_numbers_beyond_all_arms_are_refused(tmp_path, cell, told):
    lines = [*rows(range(60)), f"x,60,{cell}"]
    with pytest.raises(RunnerError, match=rf"line 62: a is {told} rad; allowed: up to 1e\+12 in magnitude"):
        read_recording(write(tmp_path, lines), said(), FACTORS)


def test_what_is_for_bags_or_fills_too_much_is_refused(tmp_path):
    path = write(tmp_path, rows(range(60)))
    with pytest.raises(RunnerError, match=r"topic: is for ROS bags \(.bag, .mcap, .db3\)"):
        read_recording(path, said().model_copy(update={"topic": "/joint_states"}), FACTORS)
    with pytest.raises(RunnerError, match=r"gaps of up to 0.1 s can be filled; found 0.2 s"):
        read_recording(path, said(), FACTORS, fill_gaps=0.2)
