"""Runs with enough repetitions that their values are stored next to the record."""

import json
import shutil

import numpy as np
import pyarrow.parquet
import pytest

import runner
from runner.metrics.summary import MOST_LISTED
from runner.reporting.comparison.pairs import MOST_PAIRS
from runner.store import DamagedError, open_run
from runner.sweeps.job import run
from runner.sweeps.measurements import measure_sweep
from runner.symbolic.engine import evaluator

pytestmark = pytest.mark.skipif(not evaluator(), reason="this many repetitions are compiled as a whole by llvmlite")
MANY = MOST_LISTED + 1
SHORT = ("robot=macro", "plant=rk4", "trajectory=goal", "noise=thesis", "duration=0.05")


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """The run, too large to be one of the shared ones; tests take copies."""
    return run(*SHORT, f"repetitions={MANY}", f"outputs={tmp_path_factory.mktemp('many')}")


@pytest.fixture
def many(stored, tmp_path):
    return open_run(shutil.copytree(stored.folder, tmp_path / "outputs" / "runs" / stored.hash))


def test_up_to_two_thousand_stand_in_the_record_and_more_beside_it(cli, many):
    few = open_run(cli(*SHORT, f"repetitions={MOST_LISTED}").folder)
    assert list(few.metrics) == list(many.metrics)
    assert not (few.folder / "values.parquet").exists()
    for name, metric in many.metrics.items():
        assert list(many.record["metrics"][name]) == ["unit", "median", "min", "max", "quantiles"]
        values = many.values(name)
        assert values.shape == (MANY,)
        # A repetition's numbers follow from only its seed.
        assert np.array_equal(values[:-1], few.values(name), equal_nan=True)
        listed = few.metrics[name].values
        assert np.array_equal(few.values(name), np.array(listed, dtype=float), equal_nan=True)
        if not np.isnan(values).any():
            assert (metric.median, metric.min, metric.max) == (np.median(values), values.min(), values.max())
            assert metric.quantiles["0.95"] == pytest.approx(np.quantile(values, 0.95), rel=1e-12)


def test_the_file_has_a_column_for_each_metric_and_null_for_none(many):
    table = pyarrow.parquet.ParquetFile(many.folder / "values.parquet").read()
    assert table.column_names == list(many.metrics)
    assert table.num_rows == MANY
    assert {str(kind) for kind in table.schema.types} == {"double"}
    assert table["steady_state_error"].null_count == MANY  # the run ends before half a second
    assert np.isnan(many.values("steady_state_error")).all()
    assert many.metrics["steady_state_error"].quantiles["0.01"] is None
    assert table["energy"].null_count == 0


def test_failed_repetitions_have_no_value(cli):
    ending = cli(
        *SHORT, f"repetitions={MANY}", "duration=0.3", "noise.position=0.1", "controller.natural_frequency=30",
        "torque_limits=none",
    )  # fmt: skip
    assert ending.code == 1
    failed = open_run(ending.folder)
    lost = np.isnan(failed.values("energy"))
    assert 0 < lost.sum() < MANY
    assert failed.failure_record["repetition"] == np.flatnonzero(lost)[0]
    assert failed.metrics["energy"].max is None


@pytest.mark.parametrize("spoil", ["flip", "remove"])
def test_damage_to_the_values_is_found_and_mended(cli, many, spoil):
    path, before = many.folder / "values.parquet", many.values("energy")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    if spoil == "flip":
        path.write_bytes(content)
    else:
        path.unlink()
    with pytest.raises(DamagedError, match=r"values\.parquet"):
        open_run(many.folder).values("energy")
    assert cli("verify", many.folder.parent.parent).code == 1
    made = cli(*SHORT, f"repetitions={MANY}")
    assert "making it again" in made.err
    assert np.array_equal(open_run(many.folder).values("energy"), before)


def test_commands_read_it(cli, many):
    other = cli(*SHORT, f"repetitions={MANY}", "controller.natural_frequency=9").folder
    assert cli("verify", many.folder.parent.parent).code == 0
    assert f"n = {MANY} repetitions" in cli("table", many.folder).out
    assert f"{MOST_PAIRS} of {MANY} pairs" in cli("compare", many.folder, other, "--metrics", "rms_torque").out
    report = cli("report", many.folder, "--format", "html").folder / "report.html"
    text = report.read_text(encoding="utf-8")
    assert f"Metrics over {MANY} repetitions; levels are quantiles" in text
    assert "99\N{NO-BREAK SPACE}%" in text


def test_python_reads_it(many):
    found = runner.open_run(many.folder)
    metric = found.metrics["energy"]
    assert metric.quantiles == many.metrics["energy"].quantiles
    assert list(metric.values) == many.values("energy").tolist()
    assert str(metric).count("J") == 1
    assert found.metrics["steady_state_error"].values == (None,) * MANY
    assert found.to_frame().loc[["energy", "steady_state_error"], "n"].tolist() == [MANY, 0]
    assert len(found.trace(MANY - 1)) == 6  # simulated again, with the metrics that are stored


@pytest.mark.parametrize("trace", ["never", "all"])
def test_cells_of_a_sweep_have_the_values_that_each_has_alone(cli, many, trace):
    swept = cli(
        *("-m", "hydra.sweeper.workers=0", *SHORT, f"repetitions={MANY}", "seed=0,1", f"sweep.trace={trace}"),
        "outputs=swept",
    )
    sweep = runner.open_sweep(swept.folder)
    runs = list(sweep.runs())
    assert [each.folder.exists() for each in runs] == [trace == "all"] * 2
    found = measure_sweep(sweep)
    for name in many.metrics:
        expected = many.values(name)
        assert np.array_equal(runs[0].values(name), expected, equal_nan=True)
        lost = np.inf if name == "settling_time" or not np.isnan(expected).all() else np.nan  # or not defined
        shown = np.where(np.isnan(expected), lost, expected)
        assert np.array_equal(found.values[name][0], shown, equal_nan=True)
        assert runs[0].metrics[name] == many.metrics[name]
    assert not np.array_equal(runs[1].values("energy"), many.values("energy"))
    assert json.dumps(runs[1].record["metrics"]).count("values") == 0
