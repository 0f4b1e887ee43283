"""A run that is stored already is found by its line, and only where nothing changed that it follows from."""

import os
import shutil
import subprocess
import sys

import pytest

from runner.base.paths import conf_dir, robots_dir
from runner.store.recall import answers, runs
from runner.store.recall.basis import basis
from runner.symbolic import cache

LINE = ("robot=macro", "plant=rk4", "duration=0.05")
OWN = ("--config-dir", "mine", "robot=arm", *LINE[1:])
CONFIG = (conf_dir() / "robot" / "macro.yaml").read_text().replace("macro.urdf", "arm.urdf")


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """Keep answers in a folder of the test's own."""
    (tmp_path / "cache").mkdir()
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "cache")


@pytest.fixture
def mine(tmp_path):
    """An own arm in an own config folder."""
    folder = tmp_path / "mine"
    (folder / "robot").mkdir(parents=True)
    shutil.copy(robots_dir() / "macro.urdf", folder / "arm.urdf")
    (folder / "robot" / "arm.yaml").write_text(CONFIG)
    return folder


@pytest.fixture
def composed(monkeypatch):
    """Count the runs that are composed and checked."""
    from runner.cli import run

    count, main = [], run.main
    monkeypatch.setattr(run, "main", lambda *given: count.append(1) or main(*given))
    return count


def test_the_second_time_nothing_is_composed(cli, composed):
    first, second = cli(*LINE), cli(*LINE)
    assert first.folder == second.folder
    assert (second.code, len(composed)) == (0, 1)
    assert "stored before" in second.err
    assert second.err.replace("stored before", "stored") == first.err


def test_a_failed_run_is_told_again_with_its_exit_code(cli, composed):
    line = ("robot=macro", "plant=rk4", "controller.natural_frequency=2000", "controller.period=0.05")
    first, second = cli(*line), cli(*line)
    assert (first.code, second.code, len(composed)) == (1, 1, 1)
    assert first.err == second.err


def test_another_line_is_composed(cli, composed):
    cli(*LINE)
    cli(*LINE, "seed=1")
    assert len(composed) == 2


@pytest.mark.usefixtures("mine")
def test_an_own_robot_is_found_again(cli, composed):
    assert cli(*OWN).folder == cli(*OWN).folder
    assert len(composed) == 1


@pytest.mark.parametrize("changed", ["arm.urdf", "robot/arm.yaml"])
def test_a_changed_file_of_the_users_counts(cli, composed, mine, changed):
    first = cli(*OWN)
    file = mine / changed
    file.write_text(file.read_text().replace('upper="1000"', 'upper="900"').replace("home: [0.0", "home: [0.1"))
    second = cli(*OWN)
    assert len(composed) == 2
    assert first.folder != second.folder


def test_a_new_file_that_comes_first_counts(cli, composed, mine):
    cli(*OWN)
    (mine / "robots").mkdir()
    shutil.copy(robots_dir() / "macro.urdf", mine / "robots" / "arm.urdf")
    cli(*OWN)
    assert len(composed) == 2


def test_a_file_that_changes_while_the_run_is_made_leaves_nothing_to_keep(cli, composed, mine, monkeypatch):
    from runner.sweeps import job

    make = job.find_or_make

    def changing(config):
        (mine / "robot" / "arm.yaml").write_text(f"{CONFIG}\n")
        return make(config)

    monkeypatch.setattr(job, "find_or_make", changing)
    cli(*OWN)
    (mine / "robot" / "arm.yaml").write_text(CONFIG)
    cli(*OWN)
    assert len(composed) == 2


def test_a_whole_path_of_a_urdf_is_not_kept(cli, composed, mine):
    line = (*OWN, f"robot.urdf={mine / 'arm.urdf'}")
    cli(*line)
    cli(*line)
    assert len(composed) == 2


def test_a_damaged_or_lost_run_is_made_again(cli, composed):
    run = cli(*LINE).folder
    (run / "trace.parquet").write_bytes(b"")
    assert "making it again" in cli(*LINE).err
    shutil.rmtree(run)
    assert cli(*LINE).folder == run
    assert len(composed) == 3


@pytest.mark.parametrize("content", ["", "[]", "{", "null"])
def test_a_damaged_answer_is_none(cli, composed, tmp_path, content):
    cli(*LINE)
    (answer,) = (tmp_path / "cache").glob("answer-*")
    answer.write_text(content)
    assert cli(*LINE).code == 0
    assert len(composed) == 2


def test_source_and_what_is_installed_count(tmp_path, monkeypatch):
    package, place = tmp_path / "package", tmp_path / "site"
    package.mkdir()
    place.mkdir()
    monkeypatch.setattr("runner.store.recall.basis.package_dir", lambda: package)
    monkeypatch.syspath_prepend(str(place))
    digests = {basis(LINE, [])}
    (package / "law.py").write_text("1")
    digests.add(basis(LINE, []))
    (package / "law.py").write_text("2")
    digests.add(basis(LINE, []))
    (place / "engine-1.dist-info").mkdir()
    digests.add(basis(LINE, []))
    assert len(digests) == 4
    assert basis(LINE, []) in digests


def test_the_folder_counts(tmp_path, monkeypatch):
    here = basis(LINE, [])
    monkeypatch.chdir(tmp_path)
    assert basis(LINE, []) != here


def test_a_large_config_folder_is_not_read(tmp_path, monkeypatch):
    (tmp_path / "a.yaml").write_text("a: 1")
    assert basis(LINE, [tmp_path]) is not None
    monkeypatch.setattr("runner.store.recall.basis._LARGEST", 3)
    assert basis(LINE, [tmp_path]) is None
    monkeypatch.setattr("runner.store.recall.basis._LARGEST", 100)
    monkeypatch.setattr("runner.store.recall.basis._MOST", 1)
    assert basis(LINE, [tmp_path]) is None


@pytest.mark.parametrize("line", [("-m", *LINE), ("--cfg", "job"), (*LINE, "hydra.mode=MULTIRUN"), (*LINE, "~noise")])
def test_lines_that_may_be_more_than_a_run_have_no_key(line):
    assert runs.line_key(line) is None


def test_lines_with_plug_ins_have_no_key(own_part):
    assert runs.line_key(LINE) is not None
    own_part("metric", "nothing", "UNITS = {}\n")
    assert runs.line_key(LINE) is None


def test_without_a_cache_folder_all_is_composed(cli, composed, monkeypatch):
    monkeypatch.setattr(cache, "folder", lambda: None)
    cli(*LINE)
    assert cli(*LINE).code == 0
    assert len(composed) == 2


def test_answers_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(answers, "_MOST", 3)
    for number in range(8):
        answers.keep(f"key{number}", number)
    assert answers.recall("key7") == 7
    assert len(list((tmp_path / "cache").iterdir())) <= 3


@pytest.mark.costs(2)
def test_a_stored_run_imports_no_simulator(tmp_path):
    heavy = "{'hydra', 'omegaconf', 'pinocchio', 'scipy', 'pandas', 'llvmlite', 'pyarrow', 'pybullet', 'mujoco'}"
    lines = f"import sys; from runner.cli.main import dispatch; dispatch({LINE}); print({heavy} & {{*sys.modules}})"
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "own")}
    told = [
        subprocess.run(
            [sys.executable, "-c", lines], check=True, cwd=tmp_path, capture_output=True, text=True, env=environment
        ).stdout.splitlines()
        for _ in range(2)
    ]
    assert told[0][-1] != "set()"  # the first time it is simulated
    assert told[1] == [told[0][0], "set()"]


def test_a_run_that_is_found_again_is_judged_by_its_lines_spec(cli, composed):
    line = (*LINE, "spec.metrics.peak_torque.max=1")
    cli(*line)
    other = cli(*LINE, "spec.metrics.peak_torque.max=1e6")
    first = cli(*line)
    assert len(composed) == 2
    assert "1 of 1" in other.err
    assert "stored before with another spec; the shares are worked out from its stored values" in first.err
    assert "0 of 1" in first.err
