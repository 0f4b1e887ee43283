"""A whole tuning: its stored and repeated trials, and the inputs of its trials."""

import numpy as np
import pytest
from support.short_runs import DAMPING, FREQUENCY

from runner import store
from runner.base.errors import ConfigError, RunnerError, StoreError
from runner.store import SchemaError
from runner.store.listing import list_entries, runs_of_sweeps
from runner.store.seal import sealed_json
from runner.sweeps.at_work import at_work
from runner.sweeps.tuning.study import JOURNAL, open_tuning

DIVERGES = ("plant=rk4", "controller.singularity_damping=0", "duration=1")
STOP = "sweep.on_failure=stop"
FRESH = 2  # runs on a seed that chooses nothing
PERIOD = "controller.period=range(0.005,0.0651,0.005)"  # 0.06 diverges


def test_every_trial_is_a_stored_run(tuned, tmp_path):
    tuning = tuned()
    assert len(tuning.trials) == 8
    for trial in tuning.trials:
        run = store.open_run(tmp_path / "outputs" / "runs" / trial.run)
        assert run.config["controller"]["natural_frequency"] == trial.params["controller.natural_frequency"]
        assert trial.values == (run.metrics["peak_torque"].median,)
        assert len(run.trace()) > 1
    assert open_tuning(tuning.folder) == tuning


def test_a_tuning_is_a_sweep_to_other_commands(tuned):
    tuning = tuned()
    sweep = store.open_sweep(tuning.folder)
    assert list(sweep.hashes) == [trial.run for trial in tuning.trials]
    assert [run.hash for run in sweep.runs()] == list(sweep.hashes)
    assert sweep.overrides[3] == tuple(tuning.study.trial_overrides(tuning.trials[3]))
    assert sweep.command == "runner tune ..."


@pytest.mark.costs(2)
def test_nothing_is_simulated_twice(tuned, simulated_runs):
    first = tuned()
    assert len(simulated_runs) == 8 + FRESH
    assert tuned() == first
    assert len(simulated_runs) == 8 + FRESH
    whole = tuned("repetitions=int(interval(1,2))", trials=6)
    assert len(set(simulated_runs)) == len(simulated_runs) == 10 + FRESH
    assert len(whole.trials) == 6


def test_more_trials_add_to_those_that_are_there(tuned, simulated_runs):
    first = tuned(trials=5)
    more = tuned(trials=9)
    assert more.folder == first.folder
    assert more.trials[:5] == first.trials
    assert len(simulated_runs) == 9 + FRESH
    assert tuned(trials=3).trials == more.trials


@pytest.mark.costs(2)
def test_trials_do_not_depend_on_where_a_tuning_was_interrupted(tuned):
    whole = tuned(trials=12)
    journal = whole.folder / JOURNAL
    lines = journal.read_bytes().splitlines(keepends=True)
    for kept in (2, 11):
        journal.write_bytes(b"".join(lines[:kept]))
        assert tuned(trials=12).trials == whole.trials
    journal.unlink()
    assert tuned(trials=12).trials == whole.trials


@pytest.mark.costs(2)
def test_the_seed_decides_what_is_tried(tuned):
    first = tuned()
    other = tuned("seed=1", FREQUENCY, DAMPING)
    assert other.folder != first.folder
    assert {trial.params[FREQUENCY.partition("=")[0]] for trial in first.trials}.isdisjoint(
        trial.params[FREQUENCY.partition("=")[0]] for trial in other.trials
    )


@pytest.mark.parametrize("change", ["trajectory.duration=2", "seed=1", FREQUENCY.replace("80", "81")])
def test_another_experiment_is_another_tuning(tuned, change):
    assert tuned(FREQUENCY, change, trials=1).folder != tuned(FREQUENCY, trials=1).folder


def test_how_it_is_made_is_no_part_of_a_tuning(tuned):
    change = ("sweep.time_limit=100", "hydra.sweeper.workers=0")
    assert tuned(FREQUENCY, *change, trials=1).folder == tuned(FREQUENCY, trials=1).folder


@pytest.mark.costs(2)
def test_a_failed_run_is_the_worst(tuned):
    tuning = tuned(*DIVERGES, PERIOD, trials=20, objectives=(("peak_torque", "maximize"), ("rms_torque", "minimize")))
    failed = [trial for trial in tuning.trials if trial.failure]
    assert failed
    runs = tuning.folder.parent.parent / "runs"
    for trial in tuning.trials:
        run = store.open_run(runs / trial.run)
        assert trial.failure == (run.failure or "")
    assert all(trial.values == (-np.inf, np.inf) for trial in failed)
    assert len([*runs.iterdir()]) == len({trial.run for trial in tuning.trials}) + FRESH < 22
    assert open_tuning(tuning.folder) == tuning


def test_default_and_tuned_config_run_on_a_seed_that_chose_nothing(tuned):
    tuning = tuned("seed=3", "repetitions=9", "noise.position=1e-4", FREQUENCY, trials=3)
    values = [trial.values[0] for trial in tuning.trials]
    assert tuning.fresh.trial == values.index(min(values))
    folder = tuning.folder.parents[1] / "runs"
    default, chosen = (store.open_run(folder / run) for run in (tuning.fresh.default, tuning.fresh.tuned))
    assert [run.config["seed"] for run in (default, chosen)] == [4, 4]
    assert [run.config["repetitions"] for run in (default, chosen)] == [9, 9]
    params = tuning.trials[tuning.fresh.trial].params
    assert chosen.config["controller"]["natural_frequency"] == params["controller.natural_frequency"]
    assert default.config["controller"]["natural_frequency"] not in [
        trial.params["controller.natural_frequency"] for trial in tuning.trials
    ]
    assert open_tuning(tuning.folder) == tuning
    runs = {trial.run for trial in tuning.trials} | {default.hash, chosen.hash}
    assert runs_of_sweeps(list_entries(tuning.folder.parents[1])) == runs


def test_a_default_config_that_cannot_run_is_not_compared(tuned, capsys):
    tuning = tuned("plant=rk4", "plant.step=0.004", "controller.period=range(0.02,0.041,0.02)", trials=2)
    assert tuning.fresh is None
    assert "default and tuned config are not compared on seed=1: 1 problem in the config" in capsys.readouterr().err


def test_what_never_settles_failed(tuned):
    tuning = tuned(
        "trajectory=goal",
        "controller.natural_frequency=interval(1,2)",
        trials=2,
        objectives=(("settling_time", "minimize"),),
    )
    assert [trial.failure for trial in tuning.trials] == ["settling_time: beyond every number"] * 2
    assert all(trial.values == (np.inf,) for trial in tuning.trials)
    assert tuning.fresh is None


def test_a_trial_that_cannot_be_run_failed(tuned):
    tuning = tuned("controller.period=0.012", "plant.step=range(0.001,0.0065,0.001)", trials=25)
    failed = [trial for trial in tuning.trials if trial.failure]
    assert {trial.params["plant.step"] for trial in failed} == {0.005}
    for trial in failed:
        assert (trial.run, trial.values) == ("", (np.inf,))
        assert "0.005" in trial.failure
    assert len(store.open_sweep(tuning.folder).hashes) == 25 - len(failed)


def test_the_first_failure_may_end_it(tuned):
    tuning = tuned(*DIVERGES, "controller.period=range(0.05,0.0651,0.005)", STOP, trials=20, at_once=1)
    assert [bool(trial.failure) for trial in tuning.trials] == [False] * (len(tuning.trials) - 1) + [True]


@pytest.mark.usefixtures("a_limit_of_ticks")
def test_a_run_that_takes_too_long_failed(tuned):
    ticked = "robot.friction.coulomb=0.5"  # its ticks are interpreted, else it ends before the limit
    tuning = tuned("duration=interval(1e3,1e4)", ticked, "sweep.time_limit=30", trials=1)
    assert tuning.trials[0].failure == "cut short: no result within sweep.time_limit, 30 s"


@pytest.mark.parametrize(
    ("overrides", "why"),
    [
        (["controller.natural_frequncy=interval(1,2)"], "unknown key (did you mean natural_frequency?)"),
        (["controller.kind=interval(1,2)"], "controller.kind: is not a number; found 'operational_space'"),
        (
            ["controller.feedforward=interval(0,1)"],
            "controller.feedforward: is not a number; found True",
        ),
        (["trajectory.goal=interval(0,1)"], "trajectory.goal: is not a number"),
        (["controller=interval(1,2)"], "controller: is a group of options, not a number"),
        (
            ["robot=combined", "controller.period=interval(0.1,0.2)"],
            "is a group of keys (macro, mini)",
        ),
        (["sweep.time_limit=interval(1,2)"], "sweep.time_limit: says how runs are made"),
        (["controller.natural_frequency=interval(-5,80)"], "controller.natural_frequency: must be"),
        (["controller.damping_ratio=interval(2,1)"], "controller.damping_ratio: its range is empty"),
        (["plant.step=0.001", "controller.period=interval(0.01,0.02)"], "controller.period"),
        (["repetitions=interval(1,5)"], "repetitions: must be a whole number"),
        ([FREQUENCY, "robot=macro,mini"], "'robot=macro,mini' is not a range to tune in"),
        ([FREQUENCY, "sweep.trace=never"], "sweep.trace: a tuning keeps the trace of every run; found 'never'"),
        ([FREQUENCY, "hydra.sweeper.workers=-1"], "hydra.sweeper.workers: must be a whole number"),
        ([FREQUENCY, "robot=macr"], "robot: no 'macr' (did you mean macro?)"),
        ([FREQUENCY, "nonsense"], "'nonsense' is not a valid override"),
        (["robot=macro"], "nothing to tune; give a key a range"),
    ],
)
def test_bad_input_is_told_before_anything_starts(tuned, tmp_path, simulated_runs, overrides, why):
    with pytest.raises(ConfigError) as error:
        tuned(*overrides)
    assert why in str(error.value)
    assert not simulated_runs
    assert not (tmp_path / "outputs").exists()


def test_problems_at_both_ends_are_told_at_once(tuned):
    with pytest.raises(ConfigError) as error:
        tuned("controller.natural_frequency=interval(-5,80)", "noise.position=interval(-1,1)", "controler.x=1")
    for problem in ("natural_frequency: must be", "noise.position: must be", "controler: unknown key"):
        assert problem in str(error.value)


def test_a_metric_that_these_runs_do_not_have_is_told(tuned):
    with pytest.raises(RunnerError, match=r"--minimize: unknown metric of these runs 'macro_settling_time'. Allowed: "):
        tuned(objectives=(("macro_settling_time", "minimize"),))


def test_two_commands_at_once_on_one_tuning(tuned, monkeypatch):
    monkeypatch.setattr("runner.sweeps.at_work._PATIENCE", 0.1)
    folder = tuned(trials=1).folder
    with (
        at_work(folder, exclusive=True),
        pytest.raises(RunnerError, match=r"another command is at work on .*, process "),
    ):
        tuned(trials=2)
    assert len(tuned(trials=2).trials) == 2


def test_a_damaged_tuning_is_told(tuned):
    folder = tuned(trials=1).folder
    (folder / "tuning.json").write_bytes(sealed_json({}))
    with pytest.raises(StoreError, match=r"tuning\.json: it does not describe a tuning: KeyError: 'overrides'"):
        open_tuning(folder)
    (folder / "tuning.json").write_text('{"schema": 2}')
    with pytest.raises(SchemaError, match=r"tuning\.json: it has schema 2, and this version reads schema 3; make it "):
        open_tuning(folder)
