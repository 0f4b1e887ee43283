"""A selection of a sweep as tidy data in SI units, as CSV and Parquet."""

import io
from dataclasses import replace

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from support.paper_sweep import by_hand

from runner.reporting.export.pooling import as_csv, as_parquet, of_one, selection
from runner.store.axes import Axis
from runner.sweeps.measurements import Measurements


def test_a_selection_in_si_units():
    sweep = by_hand()
    frame = selection(sweep, ["rms_tracking_error"])
    assert frame.columns[:4].tolist() == ["controller", "robot.payload.mass", "cells", "failed"]
    assert {name.partition(".")[0] for name in frame.columns[4:]} == {"rms_tracking_error"}
    assert frame["cells"].tolist() == [3] * 4
    expected = [np.median(sweep.values["rms_tracking_error"][start : start + 3]) for start in (0, 3, 6, 9)]
    assert frame["rms_tracking_error.median"].tolist() == pytest.approx(expected, rel=1e-15)


def test_csv_and_parquet_hold_a_selection():
    frame = selection(by_hand(), ["peak_torque"], where=["controller=operational_space"])
    pd.testing.assert_frame_equal(pd.read_csv(io.BytesIO(as_csv(frame))), frame, check_exact=True)
    parquet = as_parquet(frame, by_hand())
    pd.testing.assert_frame_equal(pd.read_parquet(io.BytesIO(parquet)), frame)
    assert pq.read_schema(io.BytesIO(parquet)).field("peak_torque.low").metadata == {b"unit": b"N m"}
    assert as_parquet(frame, by_hand()) == parquet


def test_the_csv_holds_no_formula():
    sweep = by_hand()
    axes = [Axis("controller", ["=1+1", "b"], sweep.axes[0].level), *sweep.axes[1:]]
    frame = pd.read_csv(io.BytesIO(as_csv(selection(replace(sweep, axes=axes)))))
    assert frame["controller"].tolist() == ["'=1+1", "'=1+1", "b", "b"]


def test_a_run_has_a_row_for_each_metric():
    values = {"a": np.array([[1.0, 2.0, 3.0]]), "b": np.array([[np.inf, np.inf, 1.0]])}
    run = Measurements([], [], ["x"], ["ok"], [""], {"a": "m", "b": "s"}, values, {})
    frame = of_one(run)
    assert frame[["metric", "unit", "n"]].values.tolist() == [["a", "m", 3], ["b", "s", 1]]
    assert frame["median"].iloc[0] == 2.0
    assert of_one(run, ["b"])["metric"].tolist() == ["b"]
