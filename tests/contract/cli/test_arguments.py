"""The folder that a command is about: `latest`, copies, and folders of the wrong kind."""

import shutil

import pytest

SHORT = ("robot=macro", "duration=0.05")
SWEEP = ("-m", "hydra.sweeper.workers=0", *SHORT, "seed=0,1")


def test_latest_is_the_run_or_sweep_made_or_found_last(cli, monkeypatch):
    first, second = cli(*SHORT).folder, cli(*SHORT, "seed=1").folder
    assert str(second.name) in cli("compare", "latest", first).out.splitlines()[0]
    cli(*SHORT)  # cached
    assert str(first.name) in cli("compare", "latest", second).out.splitlines()[0]
    sweep = cli(*SWEEP).folder
    assert cli("table", "latest").folder == sweep
    assert "2 runs: 2 done" in cli("status", "latest").out
    monkeypatch.setattr("runner.reporting.render.write_report", lambda *_: None)  # only its folder is asked for
    of_sweep = cli("report", "latest", "--format", "html").folder
    assert cli("report", sweep, "--format", "html").folder == of_sweep
    assert "is a run and" in cli("compare", "latest", second).err  # the sweep is meant, which was found last


def test_latest_of_a_copied_outputs_folder_which_verify_finds_good(cli):
    cli(*SWEEP)
    shutil.copytree("outputs", "copy")
    shutil.rmtree("outputs")
    assert "2 runs: 2 done" in cli("status", "copy/latest").out
    assert cli("verify", "copy").code == 0


@pytest.mark.parametrize("command", ["report", "table", "status", "check"])
def test_nothing_to_be_the_latest_is_one_line(cli, command):
    ending = cli(command, "latest")
    assert (ending.code, ending.out) == (2, "")
    assert "was made in outputs yet. Allowed: the folder of" in ending.err
    assert ending.err.count("\n") == 1


def test_a_run_in_place_of_a_sweep_is_one_line(cli, copy_run):
    run = copy_run("goal")
    ending = cli("status", run)
    assert (ending.code, ending.out) == (2, "")
    assert ending.err.startswith(f"runner: {run}: it is the folder of a run. Allowed: the folder of a sweep")
    assert ending.err.count("\n") == 1
