"""Recordings read from CSV against arrays by hand: units, rates and times."""

import numpy as np
import pytest

from runner.base import tables
from runner.base.errors import RunnerError
from runner.base.limits import Limit
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


def test_swapped_rows_are_sorted_and_repeated_ones_left_out_and_counted(tmp_path):
    times = [*range(60), *range(61, 90), 60, 59, *range(90, 120)]
    found = read_recording(write(tmp_path, rows(times)), said(), FACTORS)
    assert found.t == pytest.approx(1e-3 * np.arange(120))
    assert found.signals[Q1] == pytest.approx(np.arange(120))
    assert found.notes == [
        "2 times run back: the rows are sorted by time",
        "1 rows repeat the time of the row before and are left out",
    ]


@pytest.mark.parametrize(("rounding", "period"), [(1.0, 2.5), (10.0, 4.0)])
def test_rounded_times_are_those_of_even_rows(tmp_path, rounding, period):
    exact = period * np.arange(400)
    lines = [f"{t},{k}" for k, t in enumerate(np.round(exact / rounding) * rounding)]
    found = read_recording(write(tmp_path, ["t,a", *lines]), said(), FACTORS)
    assert found.period == pytest.approx(1e-3 * period, rel=1e-3)
    assert found.t == pytest.approx(1e-3 * exact, abs=1e-3 * rounding / 2)
    assert f"times are rounded to {rounding:g} ms" in found.notes[0]


def test_jitter_is_no_gap(tmp_path):
    times = np.cumsum(np.random.default_rng(0).choice([1.0, 2.0, 3.0, 14.0], 200, p=[0.2, 0.6, 0.15, 0.05]))
    assert len(read_recording(write(tmp_path, rows(times)), said(), FACTORS).t) == 200


def test_rows_that_repeat_the_one_before_are_left_out(tmp_path):
    values = np.sin(0.01 * np.arange(200))
    values[10::5] = values[9::5][: len(values[10::5])]
    found = read_recording(
        write(tmp_path, ["t,a", *(f"{t},{value}" for t, value in enumerate(values))]), said(), FACTORS
    )
    assert found.signals[Q1] == pytest.approx(2.0 * np.sin(10.0 * found.t))
    assert found.notes == ["38 of 200 rows repeat the positions of the row before and are left out"]


@pytest.mark.parametrize("k", [2, 4, 10])
@pytest.mark.parametrize(("torque", "new"), [("held", False), ("held", True), ("instant", True)])
@pytest.mark.parametrize("time", [{"time": {"column": "t", "unit": "ms"}}, {"rate": 1000.0}])
def test_torques_and_commands_may_be_faster_than_positions(tmp_path, k, torque, new, time):
    t = np.arange(2000.0)  # ms
    held = t // k * k
    columns = {"a": {"joint": "q1", "unit": "rad"}, "c": {"reference": "q1", "unit": "rad"},
               "u": {"torque": "q1", "unit": "N m"}}  # fmt: skip
    acts = (t if new else held) + (0.0 if torque == "instant" else 0.5 if new else 0.5 * k)  # when the torque acts
    lines = np.column_stack([t, np.sin(0.003 * held), np.sin(0.003 * t), np.cos(0.002 * acts)])
    path = write(tmp_path, ["t,a,c,u", *(",".join(f"{cell:.12g}" for cell in line) for line in lines)])
    factors = {"t": Factor(1e-3, "s"), **dict.fromkeys("ac", Factor(1.0, "rad")), "u": Factor(1.0, "N m")}
    found = read_recording(path, ColumnsMap(columns=columns, torque=torque, **time), factors)
    assert found.period == pytest.approx(1e-3 * k)
    inner = found.t[2:-2]
    for kind in ("position", "reference"):
        assert found.signals[Signal(kind, "q1")] == pytest.approx(np.sin(3.0 * found.t))
    assert found.torque_at(Signal("torque", "q1"), inner) == pytest.approx(np.cos(2.0 * inner), abs=1e-4)
    left_out = len(t) - len(found.t)
    also = f", with commands{' and torques' * new} that do not repeat"
    assert found.notes == [f"{left_out:,} of 2,000 rows repeat the positions of the row before and are left out{also}"]


def keyed(**keys):
    return ColumnsMap(rate=100.0, columns={"a": {"joint": "q1", **keys}})


@pytest.mark.parametrize(
    ("keys", "factor", "values", "wanted"),
    [
        ({"unit": "rad", "sign": -1, "zero": 3.0}, -2.0, [3.0, 4.0], [0.0, -2.0]),
        ({"unit": "%", "scale": 50.0}, 0.5, [1.0, -100.0], [0.5, -50.0]),
    ],
)
def test_sign_zero_and_per_cent(tmp_path, keys, factor, values, wanted):
    path = write(tmp_path, ["a", *map(str, values * 30)])
    found = read_recording(path, keyed(**keys), {"a": Factor(factor, "rad")}).signals[Q1]
    assert found[:2] == pytest.approx(wanted)


@pytest.mark.parametrize(("keys", "turn"), [({"unit": "deg"}, 360.0), ({"unit": "deg", "wrap": 100.0}, 100.0)])
def test_a_column_that_starts_again_goes_on(tmp_path, keys, turn):
    degrees = 5.0 * np.arange(100)
    path = write(tmp_path, ["a", *map(str, (degrees + turn / 2) % turn - turn / 2)])
    found = read_recording(path, keyed(**keys), {"a": Factor(np.pi / 180.0, "rad")})
    assert found.signals[Q1] == pytest.approx(np.radians(degrees))
    assert found.notes == [f"a jumps by a turn {int((495.0 + turn / 2) // turn)} times: the jumps are removed"]


def test_coupled_joints(tmp_path):
    said = ColumnsMap(
        rate=100.0,
        columns={
            "J2": {"joint": "q2", "unit": "rad"},
            "J3": {"joint": "q3", "unit": "rad", "coupling": {"q2": 1.0}},
        },
    )
    path = write(tmp_path, ["J2,J3", *["0.25,0.5"] * 60])
    found = read_recording(path, said, {"J2": Factor(1.0, "rad"), "J3": Factor(1.0, "rad")})
    assert found.signals[Signal("position", "q3")] == pytest.approx(np.full(60, 0.75))


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
        ([*range(30), "", *range(31, 60)], None, r"line 32: the time is missing, in 1 of 60 rows"),
        ([*range(2000), *range(60)], None, r"line 2002: the time is 0 s after 1.999 s, and runs back in 1 rows; cut"),
        ([*range(60), *range(59, 0, -1)], None, r"the time is 0.058 s after 0.059 s, and runs back in 58 rows; cut"),
        ([k // 4 for k in range(80)] + [100], None, r"has 21 values in 81 rows; say rate: instead of time:"),
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
        (["t,a,a", "0,1,2"], r"has the column 'a' more than once"),
        (
            ["t,a", "0,1", "1", "2,x", "3,inf"],
            r"line 3: 1 cells for 2 columns; line 4: a is 'x'.*line 5: a is 'inf'; allowed: a finite number",
        ),
        (["t,a", *["0,-"] * 8], r"line 6: a is '-'; allowed: a finite number; 3 more problems like these"),
        ([], r"is empty. Allowed: rows of numbers."),
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
    monkeypatch.setattr(tables, "RECORDING_ROWS", Limit(61, "rows"))
    assert len(read_recording(path, said(), FACTORS).t) == 60
    monkeypatch.setattr(tables, "RECORDING_ROWS", Limit(60, "rows"))
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
    with pytest.raises(RunnerError, match="has 1,000,000,000,000 bytes; allowed: up to 400,000,000"):
        read_recording(path, said(), FACTORS)


def test_problems_beyond_the_first_are_counted_and_empty_lines_at_the_end_are_none(tmp_path):
    assert len(read_recording(write(tmp_path, [*rows(range(60)), "", ",,"]), said(), FACTORS).t) == 60
    with pytest.raises(
        RunnerError, match=r"line 63: t is '-'; allowed: a finite number; line 64: 2 cells for 3 columns"
    ):
        read_recording(write(tmp_path, [*rows(range(60)), "", "x,-,1", "x,1", "x,3,4"]), said(), FACTORS)


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
    times = [t for t in range(200) if not 40 <= t < 64]
    lines = ["t,a", *(f"{t},{np.sin(0.05 * t)}" for t in times)]
    found = read_recording(write(tmp_path, lines), said(), FACTORS, fill_gaps=0.025)
    assert found.filled == pytest.approx([0.025])
    with pytest.raises(RunnerError, match=r"line 42: rows are missing for 0.025 s.*`--fill-gaps 25ms` fills"):
        read_recording(write(tmp_path, lines), said(), FACTORS, fill_gaps=0.024)


TWO = ColumnsMap(
    time={"column": "t", "unit": "ms"},
    columns={"a": {"joint": "q1", "unit": "rad"}, "b": {"joint": "q2", "unit": "rad"}},
)


def write_two(tmp_path, gone, other="1"):
    return write(tmp_path, ["t,a,b", *(f"{t},{'' if t in gone else t / 10},{other}" for t in range(60))])


def test_cells_of_one_column_are_filled_and_rows_without_any_are_left_out(tmp_path):
    factors = {**FACTORS, "b": Factor(1.0, "rad")}
    path = write_two(tmp_path, range(20, 25))
    with pytest.raises(RunnerError, match=r"line 22: a is missing for 0.006 s, .*; `--fill-gaps 6ms` fills"):
        read_recording(path, TWO, factors, 0.004)
    found = read_recording(path, TWO, factors, 0.006)
    assert found.filled == pytest.approx([0.006])
    assert found.signals[Q1] == pytest.approx(0.2 * np.arange(60))
    rest = read_recording(write_two(tmp_path, range(5), ""), said(), FACTORS)
    assert len(rest.t) == 55
    assert rest.notes == ["5 rows without any of the columns are left out"]


@pytest.mark.parametrize("gone", [range(5), range(55, 60)])
def test_gaps_at_an_end_are_not_filled(tmp_path, gone):
    with pytest.raises(RunnerError, match=rf"line {gone[0] + 2}: a is missing, in 5 of 60 rows and at an end; leave"):
        read_recording(write_two(tmp_path, gone), TWO, {**FACTORS, "b": Factor(1.0, "rad")}, fill_gaps=0.02)


@pytest.mark.parametrize(("cell", "told"), [("1e18", "2e\\+18"), ("-1e308", "-inf"), ("6e11", "1.2e\\+12")])
def test_numbers_beyond_all_arms_are_refused(tmp_path, cell, told):
    lines = [*rows(range(60)), f"x,60,{cell}"]
    with pytest.raises(RunnerError, match=rf"line 62: a is {told} rad; allowed: up to 1e\+12 in magnitude"):
        read_recording(write(tmp_path, lines), said(), FACTORS)


def test_what_is_for_bags_or_fills_too_much_is_refused(tmp_path):
    path = write(tmp_path, rows(range(60)))
    with pytest.raises(RunnerError, match=r"topic: is for ROS bags. Allowed: null"):
        read_recording(path, said().model_copy(update={"topic": "/joint_states"}), FACTORS)
    with pytest.raises(RunnerError, match=r"gaps of up to 0.1 s can be filled; found 0.2 s"):
        read_recording(path, said(), FACTORS, fill_gaps=0.2)
