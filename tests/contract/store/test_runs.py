"""A stored run is found again by the same line, and only if nothing that it depends on has changed."""

import shutil

import pytest

from runner.base.paths import conf_dir, robots_dir

LINE = ("robot=macro", "plant=rk4", "duration=0.05")
OWN = ("--config-dir", "mine", "robot=arm", *LINE[1:])
CONFIG = (conf_dir() / "robot" / "macro.yaml").read_text().replace("macro.urdf", "arm.urdf")


@pytest.fixture
def mine(tmp_path):
    """An own arm in an own config folder."""
    folder = tmp_path / "mine"
    (folder / "robot").mkdir(parents=True)
    shutil.copy(robots_dir() / "macro.urdf", folder / "arm.urdf")
    (folder / "robot" / "arm.yaml").write_text(CONFIG)
    return folder


@pytest.fixture
def simulated(monkeypatch):
    """Count the runs that are simulated."""
    from runner.sweeps import job

    count, simulate = [], job.simulate_run
    monkeypatch.setattr(job, "simulate_run", lambda *given: count.append(1) or simulate(*given))
    return count


def test_the_second_time_nothing_is_simulated(cli, simulated):
    first, second = cli(*LINE), cli(*LINE)
    assert first.folder == second.folder
    assert (second.code, len(simulated)) == (0, 1)
    assert "stored before" in second.err
    assert second.err.replace("stored before", "stored") == first.err


def test_a_failed_run_is_told_again_with_its_exit_code(cli, simulated):
    line = ("robot=macro", "plant=rk4", "controller.natural_frequency=2000", "controller.period=0.05")
    first, second = cli(*line), cli(*line)
    assert (first.code, second.code, len(simulated)) == (1, 1, 1)
    assert first.err == second.err


@pytest.mark.usefixtures("mine")
def test_an_own_robot_is_found_again(cli, simulated):
    assert cli(*OWN).folder == cli(*OWN).folder
    assert len(simulated) == 1


@pytest.mark.parametrize("changed", ["arm.urdf", "robot/arm.yaml"])
def test_a_changed_file_of_the_users_counts(cli, simulated, mine, changed):
    first = cli(*OWN)
    file = mine / changed
    file.write_text(file.read_text().replace('upper="1000"', 'upper="900"').replace("home: [0.0", "home: [0.1"))
    second = cli(*OWN)
    assert len(simulated) == 2
    assert first.folder != second.folder


def test_a_damaged_or_lost_run_is_made_again(cli, simulated):
    run = cli(*LINE).folder
    (run / "trace.parquet").write_bytes(b"")
    assert "making it again" in cli(*LINE).err
    shutil.rmtree(run)
    assert cli(*LINE).folder == run
    assert len(simulated) == 3


def test_a_run_that_is_found_again_is_judged_by_its_lines_spec(cli, simulated):
    line = (*LINE, "spec.metrics.peak_torque.max=1")
    cli(*line)
    other = cli(*LINE, "spec.metrics.peak_torque.max=1e6")
    first = cli(*line)
    assert len(simulated) == 1
    assert "1 of 1" in other.err
    assert "stored before with another spec; the shares are computed from its stored values" in first.err
    assert "0 of 1" in first.err
