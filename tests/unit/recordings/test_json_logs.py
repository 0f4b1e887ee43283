"""Logs in JSON: lines, an array, arrays; and what is not a log."""

import json

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.base.limits import RECORDING_NUMBERS
from runner.recordings.files import read_log

T = 0.02 * np.arange(40)
ROWS = [{"t": t, "state": {"q": [t, 2.0 * t]}, "mode": "run"} for t in T.tolist()]


def saved(tmp_path, text):
    (tmp_path / "log.json").write_text(text)
    return tmp_path / "log.json"


def lines(rows):
    return "".join(f"{json.dumps(row)}\n" for row in rows)


def changed(row, place=7):
    return [*ROWS[:place], row, *ROWS[place + 1 :]]


WHOLE = {"robot": "arm", "gains": [1.0, 2.0], "t": T.tolist(), "state": {"q": [[t, 2.0 * t] for t in T.tolist()]}}


@pytest.mark.parametrize(
    "text",
    [lines(ROWS), lines(ROWS).replace("\n", "\n\n"), json.dumps(ROWS), json.dumps(ROWS, indent=2), json.dumps(WHOLE)],
    ids=["lines", "blank lines", "array", "indented", "arrays"],
)
def test_every_form_has_the_same_names(tmp_path, text):
    found = read_log(saved(tmp_path, text))
    assert list(found.columns) == ["t", "state.q.0", "state.q.1"]
    np.testing.assert_array_equal(found.columns["state.q.1"], 2.0 * T)
    assert list(read_log(saved(tmp_path, text), ["state.q.0"]).columns)[1:2] == ["state.q.0"]


def test_texts_dates_stamps_and_lists_of_many_lengths(tmp_path):
    rows = [
        {"stamp": {"sec": 1700000000, "nanosec": 1000 * k}, "date": f"2026-05-03T10:11:{k:02d}", "on": k > 5,
         "name": ["a", "b"], "contacts": [0.0] * (k % 3), "q": float(k)}
        for k in range(30)
    ]  # fmt: skip
    found = read_log(saved(tmp_path, lines(rows)))
    assert list(found.columns) == ["stamp", "date", "on", "q"]
    assert np.ptp(found.columns["stamp"]) == pytest.approx(29e-6, abs=1e-6)
    assert np.ptp(found.columns["date"]) == 29.0
    assert found.others["name.1"] == "b"
    assert "contacts.0" in found.others


@pytest.mark.parametrize(
    "row", [{"t": 0.14, "state": {"q": [float("nan"), 1.0]}}, {"t": 0.14, "state": {"q": [None, 1.0]}}, {"t": 0.14}],
    ids=["NaN", "null", "no key"],
)  # fmt: skip
def test_what_is_not_there_is_missing_at_its_line(tmp_path, row):
    found = read_log(saved(tmp_path, lines(changed(row))))
    assert np.flatnonzero(np.isnan(found.columns["state.q.0"])).tolist() == [7]
    assert found.place(7) == "line 8"
    assert len(found) == 40


def test_the_last_line_may_be_cut_off(tmp_path):
    found = read_log(saved(tmp_path, lines(ROWS)[:-20]))
    assert len(found) == 39
    assert found.notes == ("the last line, 40, is cut off and left out",)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (lines(changed({"t": 0.14, "state": {"q": [0.1]}})), "line 8: state.q has a list of 1 values; 39 other rows"),
        (lines(changed([1.0])), r"line 8: is .*; allowed: an object"),
        (lines(changed({"state.q.0": 1.0, "state": {"q": [1.0, 2.0]}})), "has 'state.q.0' more than once"),
        (lines(changed({"t": 10**400})), "line 8: t is beyond all numbers"),
        (lines(ROWS).replace('{"t": 0.14', '{"t": 0.14x'), "line 8: is not JSON: "),
        (lines(ROWS[:3]) + "[" * 40_000 + "]" * 40_000 + "\n", "nested deeper than 100 levels"),
        (lines(ROWS[:3]) + '{"a":' * 200 + "1" + "}" * 200 + "\n", "line 4: is not JSON: nested deeper"),
        ('{"a":' * 200 + "1" + "}" * 200, "is not JSON: nested deeper than 100 levels"),
        ('{"t": 1', "is not JSON"),
        ('{"t": 1}', "has no rows. Allowed: an object on each line"),
        ("[{}", "is not JSON"),
        (lines([*ROWS[:3], {"a": "x" * 100_001}]), "characters in a row; allowed"),
        (lines({f"a{k}_{j}": 1.0 for j in range(500)} for k in range(200)), "numbers; allowed"),
    ],
    ids=lambda value: value if len(value) < 60 else "",
)  # fmt: skip
def test_what_is_no_log_is_one_sentence(tmp_path, text, told, monkeypatch):
    if "numbers; allowed" in told:
        monkeypatch.setattr("runner.recordings.json_logs.RECORDING_NUMBERS", RECORDING_NUMBERS._replace(most=1_000_000))
    with pytest.raises(RunnerError, match=told) as caught:
        read_log(saved(tmp_path, text))
    assert "\n" not in str(caught.value)
