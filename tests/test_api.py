"""A notebook does what the command line does."""

import shutil

import pytest

import runner
from runner import execution
from runner.errors import ConfigError, StoreError

SHORT = ("robot=macro", "duration=0.05", "noise=thesis", "repetitions=2")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_public_names():
    for name in runner.__all__:
        assert callable(getattr(runner, name))
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = runner.nothing


def test_a_run_has_metrics_trace_and_folder():
    run = runner.run(*SHORT)
    assert run.status == "ok"
    assert run.metrics["peak_torque"]["unit"] == "N m"
    assert len(run.metrics["peak_torque"]["values"]) == 2
    assert len(run.trace) == 6
    assert (run.folder / "metrics.json").is_file()
    assert runner.open_run(run.folder).metrics == run.metrics


def test_a_second_call_returns_the_stored_run_without_simulating(monkeypatch):
    first = runner.run(*SHORT)
    monkeypatch.setattr(execution, "simulate", None)
    second = runner.run(*SHORT)
    assert second.folder == first.folder
    assert second.record == first.record


def test_equal_configs_give_equal_bits():
    first = runner.run(*SHORT)
    trace = (first.folder / "trace.parquet").read_bytes()
    shutil.rmtree(first.folder)
    second = runner.run(*SHORT)
    assert second.metrics == first.metrics
    assert (second.folder / "trace.parquet").read_bytes() == trace


def test_the_command_line_finds_what_python_stored(cli, monkeypatch):
    run = runner.run(*SHORT)
    monkeypatch.setattr(execution, "simulate", None)
    assert cli(*SHORT).folder == run.folder.resolve()


def test_a_bad_config_raises_all_its_problems(tmp_path):
    with pytest.raises(ConfigError) as raised:
        runner.run("seed=-1", "torque_limits.max=[1,2]")
    assert len(raised.value.problems) == 2
    assert list(tmp_path.iterdir()) == []


def test_an_outputs_folder_that_cannot_be_written_to(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="cannot write file/runs"):
        runner.run("outputs=file")


def test_own_config_folders(tmp_path):
    (tmp_path / "own" / "noise").mkdir(parents=True)
    (tmp_path / "own" / "noise" / "mine.yaml").write_text(
        "position: 1e-4\ndistribution: gaussian\nvelocity: exact\nresolution: 0.0\n"
    )
    run = runner.run("noise=mine", "duration=0.05", config_dirs=[tmp_path / "own"])
    assert run.config["noise"]["distribution"] == "gaussian"
    assert run.provenance["choices"]["noise"] == "mine"
