"""`runner tune`: the best trial, the report on all of them, and what is refused."""

import math
import re
import shlex

import pytest
from support.engines import ASKED

from runner.reporting.results import rows_of
from runner.store import open_run

SHORT = ("robot=macro", "trajectory=quintic", "duration=0.05", "hydra.sweeper.workers=0")
RANGE = "controller.natural_frequency=tag(log,interval(5,80))"
TUNE = ("tune", *SHORT, RANGE, "--minimize", "peak_torque", "--trials", 4)


@pytest.fixture
def no_report(monkeypatch):
    """Let no report be rendered if only its folder is asked for."""
    monkeypatch.setattr("runner.reporting.render.write_report", lambda *_: None)


@pytest.mark.costs(2)
def test_the_best_trial_is_told_and_the_report_made_the_same_each_time(cli, tmp_path):
    ending = cli(*TUNE)
    assert ending.code == 0
    assert ending.folder.parent == tmp_path / "outputs" / "reports"
    assert {path.name for path in ending.folder.iterdir()} == {"report.html", "report.pdf"}
    best = ending.out.splitlines()[0]
    assert re.match(
        r"chosen: peak_torque [\d.]+ N m with robot=macro trajectory=quintic duration=0.05 controller", best
    )
    told = "0 of them failed\nrunner: Largest torque: "
    assert f"runner: 4 trials, {told}" in ending.err
    content = {path.name: path.read_bytes() for path in ending.folder.iterdir()}
    assert cli(*TUNE).folder == ending.folder
    assert {path.name: path.read_bytes() for path in ending.folder.iterdir()} == content
    (tmp_path / "outputs").rename(tmp_path / "copy")
    (folder,) = (tmp_path / "copy" / "tunings").iterdir()
    again = cli("report", folder).folder
    assert again == tmp_path / "copy" / "reports" / ending.folder.name
    assert {path.name: path.read_bytes() for path in again.iterdir()} == content


@pytest.mark.usefixtures("no_report")
def test_a_range_may_have_units(cli):
    ending = cli("tune", *SHORT, "controller.natural_frequency=interval(60rpm,600rpm)", *TUNE[-4:])
    assert ending.code == 0
    value = float(ending.out.splitlines()[0].rpartition("=")[2])
    assert 2.0 * math.pi <= value <= 20.0 * math.pi


@pytest.mark.usefixtures("no_report")
def test_the_best_is_the_same_run_again_and_other_commands_take_a_tuning_for_a_sweep(cli, tmp_path):
    ending = cli(TUNE[0], ASKED, *TUNE[1:])
    assert ending.code == 0
    best = ending.out.splitlines()[0]
    before = {path.name for path in (tmp_path / "outputs" / "runs").iterdir()}
    run = cli(*shlex.split(best.partition(" with ")[2])).folder
    assert run.name in before
    assert float(f"{open_run(run).metrics['peak_torque'].median:.5g}") == float(best.split()[2])
    (folder,) = (tmp_path / "outputs" / "tunings").iterdir()
    assert cli("status", folder).out.startswith("4 trials, 0 of them failed\n4 runs: 4 done, 0 left\n")
    assert cli("table", folder).code == 0
    assert (folder / "table.csv").read_text().count("\n") == 5
    assert cli("check", folder, "--save-baseline", tmp_path / "baseline.yaml").code == 0


@pytest.mark.usefixtures("no_report")
def test_of_several_objectives_the_front_is_told(cli):
    ratio = "controller.damping_ratio=range(0.5,1.5,0.5)"  # both values are ends of the range
    ending = cli(*TUNE[:-4], ratio, "--minimize", "peak_torque", "--maximize", "rms_torque", "--trials", 6)
    assert ending.code == 0
    assert re.search(r"^runner: controller.damping_ratio: .* within 2 % of the .* end of its range", ending.err, re.M)
    assert all(
        re.match(r"chosen: peak_torque \S+ N m, rms_torque \S+ N m with ", line)
        for line in ending.out.splitlines()[:-1]
    )


def test_a_tuning_in_which_every_trial_failed_has_a_report_too(cli):
    goal = ("trajectory=goal", "controller.natural_frequency=interval(1,2)")
    ending = cli("tune", *SHORT, *goal, "--minimize", "settling_time", "--trials", 2)
    assert ending.code == 1
    assert "2 trials, 2 of them failed" in ending.err
    assert (ending.folder / "report.pdf").exists()


@pytest.mark.usefixtures("no_report")
def test_all_commands_count_the_same_trials_and_one_run_of_equal_ones(cli, tmp_path):
    ratio = "controller.damping_ratio=range(0.5,1.5,0.5)"
    said = "6 trials, 6 of them failed; 2 runs, because equal trials share one"
    ending = cli("tune", *SHORT, "trajectory=goal", ratio, "--minimize", "settling_time", "--trials", 6)
    assert f"runner: {said}\n" in ending.err
    (folder,) = (tmp_path / "outputs" / "tunings").iterdir()
    counts = cli("status", folder).out.splitlines()
    assert counts[:2] == [said, "2 runs: 2 done, 0 left"]
    assert counts[2].startswith("6 of 6 stored trials have caveats")
    (listed,) = [row for row in rows_of(tmp_path / "outputs") if row.entry.kind == "tuning"]
    assert (listed.runs, listed.failed) == ("6 x 1", 6)


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (
            ["tune", *SHORT, RANGE],
            "no metric to tune for. Add --minimize METRIC or --maximize METRIC. Usage: runner tune",
        ),
        (["tune", *SHORT, RANGE, "--minimize", "peak_torqe"], "--minimize: unknown metric 'peak_torqe'"),
        (
            ["tune", *SHORT, RANGE, "--minimize", "macro_overshoot"],
            "--minimize: unknown metric of these runs 'macro_overshoot'",
        ),
        (
            ["tune", *SHORT, RANGE, "--minimize", "energy", "--maximize", "energy"],
            "--minimize and --maximize: both have the same metric",
        ),
        (
            ["tune", *SHORT, RANGE, "--minimize", "energy", "--trials", "0"],
            "--trials: not a count ('0'). Allowed: a whole number",
        ),
        (
            ["tune", *SHORT, RANGE, "--minimize", "energy", "--jobs", "x"],
            "-j/--jobs: not a count",
        ),
        (["tune", *SHORT, "--minimize", "energy"], "nothing to tune; give a key a range"),
        (
            ["tune", *SHORT, RANGE, "--minimize", "energy", "--config-dir", "none"],
            "--config-dir: no such folder ('none').",
        ),
    ],
)
def test_bad_input_is_told(cli, arguments, why):
    ending = cli(*arguments)
    assert ending.code == 2
    assert why in ending.err
    assert ending.out == ""


@pytest.mark.usefixtures("no_report")
def test_keys_of_a_robot_of_ones_own_are_tuned(cli, tmp_path):
    (tmp_path / "own" / "robot").mkdir(parents=True)
    (tmp_path / "own" / "robot" / "mine.yaml").write_text(
        "# @package _global_\ndefaults: [macro]\nrobot: {name: mine}\n"
    )
    ending = cli(
        "tune", "robot=mine", *SHORT[1:], RANGE, "--minimize=energy", "--trials=2", "--config-dir", tmp_path / "own"
    )
    assert ending.code == 0, ending.err


def test_an_experiment_that_brings_axes_is_refused(cli, tmp_path):
    line = (
        "tune",
        "experiment=sweep/frequency_period",
        "robot.payload.mass=interval(0,1)",
        "--minimize",
        "peak_torque",
    )
    ending = cli(*line)
    assert (ending.code, ending.out) == (2, "")
    axes = "controller.natural_frequency, controller.period"
    assert (
        f"hydra.sweeper.params: brings axes ({axes}), which a tuning does not sweep over. Allowed: null" in ending.err
    )
    assert list(tmp_path.iterdir()) == []
