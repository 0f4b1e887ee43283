"""Metrics of a sweep that are sensitive to rounding: in a baseline, in shards and in comparisons."""

import numpy as np
import pytest
import yaml

from runner.simulation import run as simulation
from runner.store import open_sweep
from runner.sweeps import rounding
from runner.sweeps.measurements import measure_sweep
from runner.sweeps.rounding import find_sensitive

SWEEP = ("-m", "hydra.sweeper.workers=0", "robot=macro", "plant=rk4", "noise=thesis", "torque_limits.max=40")
PERIODS = "controller.period=0.01,0.04"  # a quiet loop and a limit cycle
WILD = "controller.period=0.04"


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """Outputs for all tests, so that equal sweeps are made once."""
    return f"outputs={tmp_path_factory.mktemp('sensitive')}"


def cells(path):
    return yaml.safe_load(path.read_text())["cells"]


def marked(path):
    """Return the changes of the sensitive metrics of each cell."""
    return {
        cell: {name: one["sensitive"] for name, one in content["metrics"].items() if "sensitive" in one}
        for cell, content in cells(path).items()
    }


def test_a_baseline_marks_the_metrics_of_a_limit_cycle(cli, outputs, tmp_path):
    folder, path = cli(*SWEEP, outputs, PERIODS).folder, tmp_path / "baseline.yaml"
    ending = cli("check", folder, "--save-baseline", path)
    assert (ending.code, ending.err) == (0, "")
    found = marked(path)
    assert found["controller.period=0.01"] == {}
    assert 1e-3 < max(found[WILD].values()) <= 1.0
    assert min(found[WILD].values()) > 1e-6
    first, second = ending.out.splitlines()
    assert first.startswith("saved: ")
    assert second == f"{len(found[WILD])} are sensitive to rounding"
    assert cli("check", folder, "--baseline", path).code == 0


def test_a_run_with_plant_error_is_not_simulated_again(cli, outputs, tmp_path, monkeypatch):
    """Its changes are those that simulation finds in the same run without plant_error."""
    plain, asked = (cli(*SWEEP, outputs, PERIODS, *more).folder for more in ((), ("plant_error=true",)))
    found = find_sensitive(open_sweep(plain))
    monkeypatch.setattr(simulation, "measure_rounding", None)
    known = find_sensitive(open_sweep(asked))
    assert list(known.changes.values()) == list(found.changes.values())


def test_runs_of_other_code_stay_unmarked_and_are_counted(cli, outputs, tmp_path, monkeypatch):
    folder, path = cli(*SWEEP, outputs, PERIODS).folder, tmp_path / "baseline.yaml"
    monkeypatch.setattr("runner.sweeps.rerun.run_hash", lambda *_: "other")
    ending = cli("check", folder, "--save-baseline", path)
    assert ending.code == 0
    assert not any(marked(path).values())
    assert "2 runs are not marked because they cannot be simulated again, such as " in ending.out
    assert "the code has changed since the run" in ending.out


def test_only_the_first_runs_are_simulated(cli, outputs, tmp_path, monkeypatch):
    folder, path = cli(*SWEEP, outputs, "controller.period=0.04,0.01").folder, tmp_path / "baseline.yaml"
    monkeypatch.setattr(rounding, "MOST_RUNS", 1)
    ending = cli("check", folder, "--save-baseline", path)
    assert "1 runs are not marked because only 1 are simulated again" in ending.out
    assert marked(path)[WILD]


def test_a_failed_run_is_refused_before_anything_is_simulated(cli, outputs, tmp_path, monkeypatch):
    folder = cli(*SWEEP, outputs, "controller.natural_frequency=20,400", "torque_limits.max=1e6").folder
    monkeypatch.setattr(simulation, "measure_rounding", None)
    ending = cli("check", folder, "--save-baseline", tmp_path / "baseline.yaml")
    assert ending.code == 2
    assert "a failed run cannot be in a baseline" in ending.err


@pytest.mark.parametrize("trace", ["all", "never"])
def test_changes_of_a_sweep_are_read_by_cell(cli, outputs, trace):
    """From folders, and from a shard."""
    folder = cli(*SWEEP, outputs, PERIODS, "plant_error=true", f"sweep.trace={trace}").folder
    found = measure_sweep(open_sweep(folder)).rounding
    assert (np.array([change[0] for change in found.values()]) < 1e-6).all()
    assert max(change[1] for change in found.values()) > 1e-3
