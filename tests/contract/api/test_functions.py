"""Functions of `import runner` against the commands."""

import subprocess
import sys
from pathlib import Path

import pytest

import runner
from runner.base.errors import ConfigError, RunnerError, StoreError
from runner.sweeps import job

SHORT = ("robot=macro", "duration=0.05", "noise=thesis", "repetitions=2")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_public_names_and_no_others_are_shown():
    assert dir(runner) == sorted(runner.__all__)
    for name in runner.__all__:
        assert callable(getattr(runner, name))
        assert getattr(runner, name).__doc__
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = runner.nothing


def test_the_import_itself_brings_next_to_nothing():
    script = "import sys, runner; print(sorted({'numpy', 'hydra', 'runner.api', 'runner.plugin'} & {*sys.modules}))"
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert found.stdout == "[]\n"


def test_keywords_and_texts_make_the_same_run():
    first = runner.run(*SHORT, "controller.period=0.01")
    second = runner.run("noise=thesis", robot="macro", duration=0.05, repetitions=2, controller__period=0.01)
    third = runner.run(*SHORT, **{"controller.period": 0.01})
    assert first.folder == second.folder == third.folder
    assert first.config["controller"]["period"] == 0.01


def test_a_second_call_returns_the_stored_run_without_simulating(monkeypatch):
    first = runner.run(*SHORT)
    monkeypatch.setattr(job, "simulate_run", None)
    second = runner.run(*SHORT)
    assert second.folder == first.folder
    assert second.record == first.record


def test_the_command_line_finds_what_python_stored(cli, monkeypatch):
    run = runner.run(*SHORT)
    monkeypatch.setattr(job, "simulate_run", None)
    assert cli(*SHORT).folder == run.folder.resolve()


def test_a_bad_config_raises_all_its_problems_and_none_of_our_frames(tmp_path):
    with pytest.raises(ConfigError) as raised:
        runner.run("seed=-1", "torque_limits.max=[1,2]")
    assert len(raised.value.problems) == 2
    assert len(raised.traceback) == 2  # this line, and the wrapper
    assert raised.value.__cause__ is None
    assert raised.value.__suppress_context__
    assert list(tmp_path.iterdir()) == []


def test_an_outputs_folder_that_cannot_be_written_to(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="cannot write file/runs"):
        runner.run(outputs=tmp_path.joinpath("file").relative_to(tmp_path))


def test_own_config_folders(tmp_path):
    (tmp_path / "own" / "noise").mkdir(parents=True)
    (tmp_path / "own" / "noise" / "mine.yaml").write_text(
        "position: 1e-4\ndistribution: gaussian\nvelocity: exact\nresolution: 0.0\n"
    )
    for given in ("own", Path("own"), [tmp_path / "own"]):
        run = runner.run("noise=mine", "duration=0.05", config_dirs=given)
        assert run.config["noise"]["distribution"] == "gaussian"
        assert run.provenance["choices"]["noise"] == "mine"
    with pytest.raises(ConfigError, match="no folder none"):
        runner.run(config_dirs="none")


def test_own_parts(tmp_path):
    (tmp_path / "span_of_time.py").write_text(
        'UNITS = {"span": "s"}\n\n\ndef evaluate(trace, context):\n    return {"span": float(trace.t[-1])}\n'
    )
    run = runner.run("robot=macro", "duration=0.05", plugins=["metric=span_of_time.py"])
    assert str(run.metrics["span"]) == "50 ms"


@pytest.mark.parametrize("name", ["open_run", "open_sweep", "open_tuning"])
def test_a_folder_may_be_a_text_and_must_be_of_the_kind(name, tmp_path):
    opened = getattr(runner, name)
    for folder in ("nowhere", Path("nowhere")):
        with pytest.raises(RunnerError, match="nowhere: no such folder"):
            opened(folder)
    made = runner.run(*SHORT)
    if name == "open_run":
        assert opened(str(made.folder)).metrics == made.metrics
    else:
        with pytest.raises(
            RunnerError, match=f"it is the folder of a run. Allowed: the folder of a {name.removeprefix('open_')}"
        ):
            opened(made.folder)


def test_a_report_on_a_run():
    made = runner.report(runner.run(*SHORT).folder, formats="html")
    assert made.html == made.folder / "report.html"
    assert made.html.is_file()
    assert made.pdf is None
    assert str(made.html) in repr(made)
    assert "report.html" in made._repr_html_()


@pytest.mark.parametrize(
    ("things", "options", "message"),
    [([], {}, "nothing to report on"), (["nowhere"], {}, "nowhere: no such folder")],
)
def test_a_report_on_nothing(things, options, message):
    with pytest.raises(runner.RunnerError, match=message):
        runner.report(things, **options)


def test_a_report_in_no_format():
    with pytest.raises(runner.RunnerError, match=r"unknown report format doc; allowed: html, pdf"):
        runner.report(runner.run(*SHORT), formats="doc")


def test_a_tuning_and_its_best_run():
    words = {"robot": "macro", "trajectory": "quintic", "duration": 0.05, "workers": 0, "trials": 3}
    tuning = runner.tune(controller__natural_frequency=(5, 50), minimize="max_tracking_error", **words)
    table = tuning.to_frame()
    assert list(table.columns) == ["controller.natural_frequency", "max_tracking_error", "failure", "hash", "best"]
    assert len(table) == 3
    best = table[table["best"]].iloc[0]
    assert best["max_tracking_error"] == table["max_tracking_error"].min()
    assert tuning.best().hash == best["hash"]
    assert tuning.best().metrics["max_tracking_error"].median == best["max_tracking_error"]
    assert runner.open_tuning(str(tuning.folder)).to_frame().equals(table)
    assert "3 trials of controller.natural_frequency, 0 of them failed" in repr(tuning)
    assert "max_tracking_error" in tuning._repr_html_()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "name each metric once"),
        ({"minimize": "peak_torque", "maximize": "peak_torque"}, "name each metric once"),
        ({"minimize": "peak"}, "--minimize: unknown metric 'peak'"),
        ({"minimize": "peak_torque", "trials": 0}, "trials: must be a whole number, 1 or more; found 0"),
        ({"minimize": "peak_torque", "seed": (1, 2, 3)}, "a range has two ends"),
        ({"minimize": "peak_torque"}, "nothing to tune"),
    ],
)
def test_what_cannot_be_tuned(values, message):
    with pytest.raises(runner.RunnerError, match=message):
        runner.tune("robot=macro", **values)


def test_a_calibration():
    found = runner.calibrate(calibration="gravity", calibration__orientations=8, repetitions=2)
    assert found.status == "ok"
    assert repr(found) == f"Calibration of {', '.join(found.truth)}\n  {found.folder}"
