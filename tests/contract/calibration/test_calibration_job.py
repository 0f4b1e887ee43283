"""A calibration as a job: stored once, whole or not at all, and read back."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from runner.base.errors import StoreError
from runner.config.compose.compose import compose
from runner.plugins import discovery
from runner.simulation import provenance
from runner.store import open_calibration
from runner.store.seal import sealed_json
from runner.sweeps import job as jobs
from runner.sweeps.job import calibrate


@pytest.fixture
def job(tmp_path):
    return lambda *overrides: calibrate(*overrides, "repetitions=5", f"outputs={tmp_path}/outputs")


def test_a_calibration_is_a_folder_of_its_own(job, tmp_path):
    done = job()
    assert done.folder == tmp_path / "outputs" / "calibrations" / done.hash
    assert sorted(path.name for path in done.folder.iterdir()) == ["config.yaml", "result.json", "robot.urdf"]
    config = yaml.safe_load((done.folder / "config.yaml").read_text())
    assert set(config) == {"seed", "repetitions", "gravity", "outputs", "robot", "wrist_sensor", "calibration"}
    assert done.provenance["command"] == "runner calibrate repetitions=5"


def test_an_equal_config_returns_the_stored_one(job, monkeypatch):
    first = job("calibration=gravity")
    monkeypatch.setattr(jobs, "simulate_calibration", None)
    second = job("calibration=gravity")
    assert (second.folder, second.record) == (first.folder, first.record)
    assert job("calibration=gravity", "wrist_sensor=mini40").hash == first.hash


@pytest.mark.parametrize("change", ["seed=1", "wrist_sensor.rotation=0.4", "calibration.samples=2", "gravity=9.8"])
def test_another_config_is_another_calibration(job, change):
    assert job("calibration=gravity", change).hash != job("calibration=gravity").hash


def test_the_command_names_ones_own_parts_and_folders(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine").mkdir()
    monkeypatch.setattr(discovery, "named_parts", lambda: ["calibration=mine/own.py"])
    composed = compose(("seed=1", "outputs=else"), [Path("mine")], root="calibrate")
    assert provenance.command(composed, "calibrate") == (
        "runner --plugin calibration=mine/own.py calibrate --config-dir mine seed=1"
    )


@pytest.mark.parametrize("name", ["result.json", "config.yaml", "robot.urdf"])
def test_a_damaged_one_is_carried_out_again(job, name):
    first = job()
    urdf, path = first.urdf, first.folder / name
    path.write_text(path.read_text()[:100]) if name == "result.json" else path.unlink()
    again = job()
    assert again.urdf == urdf
    clocked = dict.fromkeys(("timing", "digest"))
    assert {**again.record, **clocked} == {**first.record, **clocked}


def test_estimates_errors_and_truth_belong_together(job):
    done = job("calibration=gravity")
    truth = np.array(list(done.truth.values()))
    np.testing.assert_allclose(done.values("estimates") - truth, done.values("errors"), atol=1e-14)
    assert done.values("deviations").shape == (5, 11)
    mass = done.summary("errors", "mass")
    assert mass["unit"] == "kg"
    assert (mass["median"], mass["min"], mass["max"]) == (
        np.median(mass["values"]),
        min(mass["values"]),
        max(mass["values"]),
    )
    assert done.truth["mass"] == 0.25
    assert done.truth["theta"] == 0.3


def test_the_centre_of_mass_is_the_tool_s_seen_from_the_sensor(job):
    truth = job("calibration=gravity", "wrist_sensor.rotation=1.5707963267948966").truth
    np.testing.assert_allclose([truth[f"r_{axis}"] for axis in "xyz"], [0.0, -0.01, 0.04 - 0.0122], atol=1e-15)


def test_repetitions_start_alike_however_many_there_are(tmp_path):
    few, many = (calibrate(f"repetitions={count}", f"outputs={tmp_path}") for count in (2, 6))
    np.testing.assert_array_equal(few.values("errors"), many.values("errors")[:2])


def test_the_band_narrows_with_the_repetitions_and_is_left_out_where_nothing_errs(tmp_path):
    bands = [calibrate(f"repetitions={n}", f"outputs={tmp_path}").consistency for n in (5, 40)]
    widths = [band["upper"] - band["lower"] for band in bands]
    assert widths[0] > 2.0 * widths[1]
    assert calibrate("calibration.repeatability=0", "repetitions=2", f"outputs={tmp_path}").consistency is None
    exact_sensor = ("calibration=gravity", "wrist_sensor=ideal")  # the centre of mass is then exact
    assert calibrate(*exact_sensor, "repetitions=2", f"outputs={tmp_path}").consistency is None


def test_another_arm_is_calibrated_with_a_tool_on_it(tmp_path):
    tool = "robot.tool={mass:1.0,centre_of_mass:[0,0,0.05],inertia:[1e-3,1e-3,1e-4],tip:[0,0,0.1],tip_radius:0.01}"
    for kind in ("tool_centre_point", "gravity"):
        done = calibrate("robot=xarm7", tool, f"calibration={kind}", f"outputs={tmp_path}")
        assert done.consistency["holds"]
        assert done.postures.shape[1] == 7


def test_what_is_no_calibration_is_refused(tmp_path, job):
    with pytest.raises(StoreError, match=r"cannot read .*result\.json: No such file"):
        open_calibration(tmp_path)
    done = job()
    (done.folder / "result.json").write_bytes(sealed_json({"files": done.record["files"]}))
    with pytest.raises(StoreError, match=r"it is not a calibration's result: estimates, truth, .* missing"):
        open_calibration(done.folder)
