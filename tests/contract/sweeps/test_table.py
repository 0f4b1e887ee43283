"""The table of a sweep against rows by hand: medians, lost and absent repetitions."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from runner.statistics import median_interval
from runner.store import write_sweep
from runner.store.axes import Axis
from runner.sweeps.job import run
from runner.sweeps.measurements import Measurements
from runner.sweeps.table import table, write_table


@pytest.fixture
def measurements():
    """Two cells of four repetitions; the second lost two of them."""
    return Measurements(
        axes=[Axis("noise.position", [1e-4, 1e-3], np.array([1, 0]))],
        fixed=[],
        hashes=["aa", "bb"],
        statuses=["ok", "failed"],
        failures=["", "diverged, at once"],
        units={"rms": "m", "settling_time": "s"},
        values={
            "rms": np.array([[4.0, 1.0, 3.0, 2.0], [1.0, np.inf, 2.0, np.inf]]),
            "settling_time": np.array([[1.0, 2.0, np.nan, np.nan], [np.inf] * 4]),
        },
        provenance={},
    )


def test_a_row_for_each_cell_by_hand(measurements):
    frame = table(measurements)
    assert frame["noise.position"].tolist() == [1e-3, 1e-4]
    assert frame["status"].tolist() == ["ok", "failed"]
    assert frame["hash"].tolist() == ["aa", "bb"]
    assert frame["rms.median"].iloc[0] == 2.5
    assert frame[["rms.q05", "rms.q25", "rms.q75", "rms.q95", "rms.n"]].iloc[0].tolist() == [1.0, 1.0, 3.0, 4.0, 4]


def test_lost_repetitions_count_as_beyond_every_number(measurements):
    row = table(measurements).iloc[1]
    assert row[["rms.q05", "rms.q25", "rms.n"]].tolist() == [1.0, 1.0, 2]
    assert np.isnan([row["rms.median"], row["rms.q75"], row["rms.q95"]]).all()
    assert row["settling_time.n"] == 0
    assert np.isnan(row["settling_time.q05"])


def test_absent_repetitions_do_not_count(measurements):
    row = table(measurements).iloc[0]
    assert row[["settling_time.median", "settling_time.q95", "settling_time.n"]].tolist() == [1.5, 2.0, 2]


@pytest.mark.parametrize("count", [1, 2, 7, 20, 40])
def test_quantiles_are_the_smallest_values_that_so_many_do_not_exceed(count):
    values = np.random.default_rng(count).normal(size=(3, count))
    frame = table(Measurements([], [], list("abc"), ["ok"] * 3, [""] * 3, {"m": "m"}, {"m": values}, {}))
    for share in (0.05, 0.25, 0.75, 0.95):
        expected = np.quantile(values, share, axis=1, method="inverted_cdf")
        assert frame[f"m.q{round(100 * share):02d}"].tolist() == expected.tolist()


def test_both_files_hold_the_table_and_parquet_the_units(measurements, tmp_path):
    write_table(measurements, tmp_path)
    frame = table(measurements)
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "table.parquet"), frame)
    texts = {"failure": "", "caveats.rules": ""}
    from_csv = pd.read_csv(tmp_path / "table.csv", dtype=dict.fromkeys(texts, str)).fillna(texts)
    pd.testing.assert_frame_equal(from_csv, frame, check_dtype=False, check_exact=True)
    schema = pq.read_schema(tmp_path / "table.parquet")
    assert schema.field("settling_time.q75").metadata == {b"unit": b"s"}
    assert schema.field("rms.low").metadata == {b"unit": b"m"}
    assert schema.field("rms.n").metadata is None
    assert schema.field("noise.position").metadata is None


def test_the_interval_of_the_median_is_that_of_reports():
    values = np.random.default_rng(0).normal(size=(4, 8))
    values[1, 5:], values[2, :] = np.nan, np.inf
    values[3, 4:] = np.inf
    frame = table(Measurements([], [], list("abcd"), ["ok"] * 4, [""] * 4, {"m": "m"}, {"m": values}, {}))
    found = median_interval(values[0])
    assert frame[["m.low", "m.median", "m.high"]].iloc[0].tolist() == [found.low, found.median, found.high]
    # Too few repetitions; all of them beyond every number; half of them.
    assert frame[["m.low", "m.high"]].isna().values.tolist()[1:] == [[True, True], [True, True], [False, True]]
    assert frame["m.n"].tolist() == [8, 5, 0, 4]


CASE = (
    "robot=macro",
    "trajectory=quintic",
    "trajectory.goal=[0.8,0.6,0.7]",
    "duration=0.2",
    "repetitions=3",
    "outputs=o",
)


def test_the_table_of_a_stored_sweep_holds_what_its_runs_hold(cli, tmp_path):
    cells = [(f"noise.position={noise}", *CASE) for noise in ("1e-4", "1e-3")]
    runs = [run(*overrides) for overrides in cells]
    jobs = [(overrides, stored.hash) for overrides, stored in zip(cells, runs, strict=True)]
    folder = write_sweep(tmp_path / "o", jobs, "runner -m ...")
    ending = cli("table", folder)
    assert ending.code == 0
    assert ending.folder == folder
    assert "2 cells, 0 of them failed" in ending.out
    frame = pd.read_parquet(folder / "table.parquet")
    assert frame["hash"].tolist() == [stored.hash for stored in runs]
    assert runs[1].metrics
    for name, metric in runs[1].metrics.items():
        median = np.nan if metric.median is None else metric.median
        assert frame[f"{name}.median"].iloc[1] == pytest.approx(median, rel=1e-15, nan_ok=True)
        assert frame[f"{name}.n"].iloc[1] == 3 - metric.values.count(None)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "the following arguments are required: DIR. Usage: runner table"),
        (("nowhere",), "nowhere: no such folder. Allowed: the folder of a sweep"),
        ((".",), ".: it is not the folder of a stored result. Allowed: the folder of a sweep"),
    ],
)
def test_bad_input_is_told(cli, arguments, message):
    ending = cli("table", *arguments)
    assert ending.code == 2
    assert message in ending.err
    assert ending.out == ""


def test_the_csv_holds_no_formula_and_numbers_stay_numbers(measurements, tmp_path):
    axes = [
        Axis("robot.name", ['=HYPERLINK("http://x")', "@SUM(1)"], np.array([0, 1])),
        Axis("trajectory.goal", [-0.5, 0.25], np.array([0, 1])),
    ]
    cells = replace(measurements, axes=axes, failures=["", "-1+1\x1b[2J\nis no number"])
    write_table(cells, tmp_path)
    frame = pd.read_csv(tmp_path / "table.csv")
    assert frame["robot.name"].tolist() == ['\'=HYPERLINK("http://x")', "'@SUM(1)"]
    assert frame["trajectory.goal"].tolist() == [-0.5, 0.25]
    assert frame["failure"].iloc[1] == "'-1+1\\x1b[2J\\nis no number"
    assert pd.read_parquet(tmp_path / "table.parquet")["robot.name"].tolist() == axes[0].values


def test_cells_that_differ_beyond_the_axes_are_told_in_a_line(cli):
    short = ("trajectory=quintic", "noise=thesis", "duration=0.05", "outputs=o")
    swept = cli("-m", "robot=macro,xarm7", *short, "hydra.sweeper.workers=0")
    line = "config values differ beyond the swept axes with robot: robot.settling_band, "
    assert line in swept.err
    (said,) = [text for text in cli("table", swept.folder).out.splitlines() if line in text]
    assert said.endswith(f"`runner report {swept.folder}` lists their values")
    plain = cli("-m", "robot=macro", "noise.position=1e-4,1e-3", *short[:1], *short[2:], "hydra.sweeper.workers=0")
    assert "beyond the swept axes" not in plain.err + cli("table", plain.folder).out
