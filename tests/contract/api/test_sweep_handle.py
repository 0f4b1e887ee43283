"""A sweep from Python: the engine of the command line, and its results as tables."""

import shutil

import numpy as np
import pytest

import runner
from runner.base.quantities import quantity
from runner.sweeps.measurements import measure_sweep
from runner.sweeps.table import table

CONTROLLERS = ["operational_space", "computed_torque"]
SHORT = ("trajectory=quintic", "noise=thesis", "duration=0.05")


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    outputs = tmp_path_factory.mktemp("outputs")
    axes = {"robot": ["macro", "mini"], "controller": CONTROLLERS, "seed": range(2)}
    return runner.sweep(*SHORT, repetitions=6, outputs=outputs, workers=0, **axes)


def test_its_cells_are_those_of_the_command_line(sweep, cli, simulated_runs):
    words = (*SHORT, "repetitions=6", f"outputs={sweep.folder.parent.parent}")
    ending = cli("-m", *words, "robot=macro,mini", f"controller={','.join(CONTROLLERS)}", "seed=range(0,2)")
    assert ending.code == 0, ending.err
    assert ending.folder == sweep.folder.resolve()
    assert simulated_runs == []
    assert sweep.command.startswith("runner -m trajectory=quintic noise=thesis")


def test_an_experiment_brings_its_axes_along(tmp_path):
    (tmp_path / "mine/experiment").mkdir(parents=True)
    (tmp_path / "mine/experiment/two.yaml").write_text(
        "# @package _global_\nhydra:\n  sweeper:\n    params: {noise.position: '1e-4,1e-3'}\n"
    )
    words = ("robot=macro", "experiment=two", "duration=0.05")
    sweep = runner.sweep(*words, seed=[0, 1], config_dirs=tmp_path / "mine", outputs=tmp_path, workers=0)
    assert sweep.axes == {"noise.position": [1e-4, 1e-3], "seed": [0.0, 1.0]}


def test_it_knows_its_axes_and_runs(sweep):
    assert len(sweep) == 8
    assert sweep.axes == {"robot": ["macro", "mini"], "controller": CONTROLLERS, "seed": [0.0, 1.0]}
    assert [run.status for run in sweep.runs()] == ["ok"] * 8
    run = sweep.run(robot="mini", controller="computed_torque", seed=1)
    assert (run.config["robot"]["name"], run.config["controller"]["kind"]) == ("mini", "computed_torque")
    assert run.config["seed"] == 1


def test_as_text_and_as_a_page(sweep):
    lines = repr(sweep).splitlines()
    assert lines[0].startswith("Sweep of 8 runs: all made")
    assert lines[1:] == [
        "  robot: macro, mini",
        f"  controller: {', '.join(CONTROLLERS)}",
        "  seed: 0, 1",
        f"  {sweep.folder}",
    ]
    page = sweep._repr_html_()
    assert page.count("<tr>") == 9
    median = sweep.run(robot="mini", controller="computed_torque", seed=1).metrics["max_tracking_error"].median
    assert "largest tracking error, median" in page
    assert quantity(median, "m") in page
    assert str(sweep.folder) in page


def test_the_table_has_a_row_for_each_cell_and_metric(sweep):
    tidy = sweep.to_frame(["peak_torque", "energy"])
    keys = ["robot", "controller", "seed"]
    assert list(tidy.columns) == [*keys, "metric", "unit", "median", "low", "high", "n", "status", "caveats"]
    assert len(tidy) == 16
    wide = table(measure_sweep(sweep))
    for name in ("peak_torque", "energy"):
        part = tidy[tidy["metric"] == name].reset_index(drop=True)
        for column in ("median", "low", "high", "n"):
            np.testing.assert_array_equal(part[column], wide[f"{name}.{column}"])
    assert set(sweep.to_frame()["metric"]) == set(measure_sweep(sweep).values)
    assert sweep.to_frame("energy").equals(sweep.to_frame(["energy"]))


def test_values_of_each_repetition(sweep):
    values = sweep.to_frame("peak_torque", level="repetitions")
    assert list(values.columns) == ["robot", "controller", "seed", "repetition", "metric", "unit", "value"]
    assert len(values) == 48
    assert (set(values["metric"]), set(values["unit"])) == ({"peak_torque"}, {"N m"})
    assert len(sweep.to_frame(["peak_torque", "energy"], level="repetitions")) == 96
    chosen = values[(values["robot"] == "mini") & (values["controller"] == "computed_torque") & (values["seed"] == 1)]
    run = sweep.run(robot="mini", controller="computed_torque", seed=1)
    assert tuple(chosen["value"]) == run.metrics["peak_torque"].values


def test_a_comparison_is_in_pairs_of_equal_seeds(sweep):
    found = sweep.compare(by="controller", within="robot", metrics=["peak_torque"])
    assert list(found.columns) == [
        "robot", "first", "second", "metric", "unit", "difference", "low", "high", "n", "effect", "p", "word",
    ]  # fmt: skip
    assert len(found) == 2
    values = sweep.to_frame("peak_torque", level="repetitions")
    values = values.set_index(["robot", "controller", "seed", "repetition"])["value"].sort_index()
    for _, row in found.iterrows():
        differences = values[row["robot"], row["second"]] - values[row["robot"], row["first"]]
        assert row["n"] == len(differences) == 12
        means = np.add.outer(differences.to_numpy(), differences.to_numpy())[np.triu_indices(len(differences))] / 2
        assert row["difference"] == pytest.approx(np.median(means), rel=1e-12)  # Hodges and Lehmann
        assert row["low"] <= row["difference"] <= row["high"]
    assert len(sweep.compare(by="controller", within=["robot", "seed"], metrics="peak_torque")) == 4


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (lambda sweep: sweep.to_frame("peak"), "unknown metric 'peak'"),
        (lambda sweep: sweep.to_frame("peak_torqe", "repetitions"), r"Did you mean 'peak_torque'\?"),
        (
            lambda sweep: sweep.to_frame(level="cell"),
            r"level: unknown name 'cell'. Allowed: cells, repetitions. Did you mean 'cells'\?",
        ),
        (lambda sweep: sweep.compare(by="robt"), r"unknown axis 'robt'. .* Did you mean 'robot'\?"),
        (lambda sweep: sweep.compare(by="robot", metrics="peak"), "unknown metric 'peak'"),
        (lambda sweep: sweep.run(robt="macro"), r"unknown axis 'robt'. .* Did you mean 'robot'\?"),
        (lambda sweep: sweep.run(robot="makro"), r"robot: unknown value 'makro'. .* Did you mean 'macro'\?"),
        (
            lambda sweep: sweep.run(robot="macro"),
            "4 runs have these values; name one value of controller: .*; seed: 0, 1",
        ),
    ],
)
def test_what_is_not_there_is_told_in_a_line(sweep, asked, message):
    with pytest.raises(runner.RunnerError, match=message) as raised:
        asked(sweep)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"workers": -1}, "workers: must be a whole number"),
        ({"robot": ["macro", "makro"]}, "makro"),
        ({"hydra__sweeper__workers": 3}, r"give workers=\.\.\. and address=\.\.\. as arguments"),
        ({"seed": []}, "seed: is swept over no value"),
    ],
)
def test_what_cannot_be_swept(values, message, tmp_path):
    with pytest.raises(runner.RunnerError, match=message):
        runner.sweep("robot=macro", outputs=tmp_path / "outputs", **values)
    assert not (tmp_path / "outputs").exists()


def test_a_sweep_that_is_not_all_made_says_so(sweep, tmp_path):
    outputs = shutil.copytree(sweep.folder.parent.parent, tmp_path / "outputs")
    part = runner.open_sweep(outputs / "sweeps" / sweep.folder.name)
    shutil.rmtree(outputs / "runs" / part.run(robot="mini", controller="computed_torque", seed=1).hash)
    assert "1 not made yet" in repr(part)
    assert "1 not made yet" in part._repr_html_()
    for asked in (part.to_frame, lambda: part.to_frame(level="repetitions"), lambda: part.compare(by="robot")):
        with pytest.raises(runner.RunnerError, match=r"1 of 8 cells of .* are not stored; continue with: runner -m "):
            asked()
    assert part.run(robot="mini", controller="computed_torque", seed=0).status == "ok"
    runner.sweep(
        *SHORT, repetitions=6, outputs=outputs, workers=0, robot="macro,mini", controller=CONTROLLERS, seed="0,1"
    )
    assert len(part.to_frame("energy")) == 8
