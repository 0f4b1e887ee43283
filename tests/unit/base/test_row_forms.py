"""Text tables with a row for each joint, and with lists in cells."""

import numpy as np
import pandas as pd
import pytest

from runner.base.errors import RunnerError
from runner.base.tables import read_table

T = 0.02 * np.arange(60)
Q = np.column_stack([np.sin(T), np.cos(T), T**2])
NAMES = ("base", "elbow", "wrist")


def long(names=NAMES):
    rows = [(t, name, q, 2.0 * q) for t, row in zip(T, Q, strict=True) for name, q in zip(names, row, strict=True)]
    return pd.DataFrame(rows, columns=["time", "joint", "position", "effort"])


def saved(tmp_path, table, **options):
    table.to_csv(tmp_path / "log.csv", **{"index": False, **options})
    return tmp_path / "log.csv"


def lists(make=list):
    return pd.DataFrame({"t": T, "q": [make(row) for row in Q.tolist()], "mode": "run"})


@pytest.mark.parametrize("order", [["time", "joint"], ["joint", "time"]])
@pytest.mark.parametrize("index", [False, True])
def test_rows_of_single_joints_become_columns(tmp_path, order, index):
    found = read_table(saved(tmp_path, long().sort_values(order), index=index))
    assert found.form == "text, cells separated by commas, a row for each joint"
    for place, name in enumerate(NAMES):
        np.testing.assert_array_equal(found.columns["time"], T)
        np.testing.assert_array_equal(found.columns[f"{name}.position"], Q[:, place])
        np.testing.assert_array_equal(found.columns[f"{name}.effort"], 2.0 * Q[:, place])


def test_joints_may_have_numbers_and_a_melted_table_its_names(tmp_path):
    assert "joint2.position" in read_table(saved(tmp_path, long((1, 2, 3)))).columns
    melted = pd.DataFrame(Q, columns=NAMES).assign(t=T).melt("t")
    found = read_table(saved(tmp_path, melted), ["elbow", "t"])
    assert list(found.columns) == ["elbow", "t"]
    np.testing.assert_array_equal(found.columns["elbow"], Q[:, 1])


def test_a_joint_without_a_row_is_missing_at_its_line(tmp_path):
    found = read_table(saved(tmp_path, long().drop(index=31)))
    assert np.flatnonzero(np.isnan(found.columns["elbow.position"])).tolist() == [10]
    assert found.place(10) == "line 32"
    assert np.isfinite(found.columns["base.position"]).all()


def test_a_joint_with_two_rows_at_a_time_is_named(tmp_path):
    table = long()
    table.loc[31, "joint"] = "base"
    with pytest.raises(RunnerError, match=r"log.csv: line 33: base has a second row at time 0.2"):
        read_table(saved(tmp_path, table))


@pytest.mark.parametrize("name", ["joint", "name", "id"])
def test_another_column_of_such_a_name_changes_nothing(tmp_path, name):
    values = "arm" if name == "name" else np.arange(len(T))
    found = read_table(saved(tmp_path, pd.DataFrame({"t": T, name: values, "q": Q[:, 0]})))
    assert len(found) == len(T)
    assert {"t", "q"} <= set(found.columns)


@pytest.mark.parametrize("make", [list, tuple, np.array], ids=["list", "tuple", "array"])
@pytest.mark.parametrize("sep", [",", ";", "\t"])
def test_lists_in_cells_are_columns(tmp_path, make, sep):
    found = read_table(saved(tmp_path, lists(make), sep=sep))
    assert list(found.columns) == ["t", "q.0", "q.1", "q.2"]
    assert found.columns["q.2"] == pytest.approx(Q[:, 2], abs=1e-6)
    assert list(read_table(saved(tmp_path, lists(make)), ["t", "q.1"]).columns) == ["t", "q.1"]


@pytest.mark.parametrize(
    ("cell", "told"),
    [
        ("[0.1, 0.2]", r"line 12: q has a list of 2 numbers; the first row has 3"),
        ("[[0.1], [0.2]]", r"line 12: q is '\[\[0.1\], \[0.2\]\]'; allowed: a list of 3 numbers"),
        ("__import__('os')", r"line 12: q is .*; allowed: a list of 3 numbers"),
    ],
)
def test_a_list_unlike_the_others_is_named(tmp_path, cell, told):
    lines = saved(tmp_path, pd.concat([lists()] * 2)).read_text().splitlines()
    for number in (12, 81):  # among the first rows, and after them
        (tmp_path / "log.csv").write_text("\n".join([*lines[: number - 1], f'0.4,"{cell}",run', *lines[number:]]))
        with pytest.raises(RunnerError, match=told.replace("12", str(number))):
            read_table(tmp_path / "log.csv", ["t", "q.0"])


def test_a_missing_list_is_missing_numbers(tmp_path):
    table = lists().astype({"q": object})
    table.loc[10, "q"] = None
    assert np.isnan(read_table(saved(tmp_path, table)).columns["q.1"]).sum() == 1
