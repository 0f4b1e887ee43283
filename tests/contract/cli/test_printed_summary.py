"""The last lines of runs and sweeps: key metrics, failures, what comes next."""

import re

from fixtures.stored import RUNS
from support.engines import ASKED

from runner.reporting.metric_titles import key_metrics
from runner.reporting.run_report import run_document

SHORT = ("robot=macro", ASKED, "trajectory=quintic", "trajectory.duration=0.5", "duration=1.2")


def test_a_run_tells_its_key_metrics_with_units(cli):
    ending = cli(*SHORT)
    head, *metrics = ending.err.splitlines()
    assert (
        head == f"runner: macro, operational_space, quintic: 1 repetition, stored in outputs/runs/{ending.folder.name}"
    )
    assert [line.split("  ")[1] for line in metrics] == [
        "largest tracking error", "steady-state error", "largest torque", "share of ticks at a torque limit",
        "rms tracking error",
    ]  # fmt: skip
    assert " N m" in metrics[2]
    assert ending.out == f"outputs/runs/{ending.folder.name}\n"


def test_several_repetitions_have_a_median_and_a_range(cli):
    ending = cli(*SHORT, "noise.position=1mrad", "noise.distribution=uniform", "repetitions=3")
    assert ": 3 repetitions, stored in " in ending.err
    (largest,) = (line for line in ending.err.splitlines() if "largest tracking error" in line)
    assert " to " in largest
    assert largest.endswith("median of 3")
    assert "runner: caveat: exact_velocity: " in ending.err


def test_a_goal_that_is_not_reached_is_told(cli):
    ending = cli("robot=macro", ASKED, "trajectory=goal", "duration=0.1")
    (settling,) = (line for line in ending.err.splitlines() if "settling time" in line)
    assert "–" in settling
    assert settling.endswith("not reached in half of the repetitions or more")
    assert "steady-state error" not in ending.err  # it has none


def test_a_failed_run_tells_why_and_no_metrics(cli):
    ending = cli(*RUNS["failed"])
    assert ending.code == 1
    assert "runner: failed in repetition 0 at t = 0.6 s (q1): diverged" in ending.err
    assert "largest torque" not in ending.err
    assert "repetition, stored" not in ending.err


def test_a_sweep_tells_its_counts_what_may_be_said_and_what_comes_next(cli):
    sweep = ("-m", "hydra.sweeper.workers=0", *SHORT, "controller.period=5ms,10ms")
    *_, counts, told, scope, following = cli(*sweep).err.splitlines()
    assert re.fullmatch(
        r"runner: Not challenged: `runner challenge latest` \(about \d+ s, longer at first use\) tries other choices\.",
        scope,
    )
    assert counts == "runner: 2 runs: 2 made, 0 stored before, none of them failed"
    assert " % smaller with controller.period=0.005 (" in told
    assert ", exactly: nothing is drawn, integration error " in told
    assert "pair" not in told
    compare = "`runner compare latest`"
    assert following == f"runner: next: `runner report latest`, `runner table latest`, {compare}"
    counts = next(
        line for line in cli(*sweep[:-1], "controller.period=5ms,10ms,2ms").err.splitlines() if "made" in line
    )
    assert counts == "runner: 3 runs: 1 made, 2 stored before, none of them failed"


def test_a_sweep_elsewhere_names_its_folder(cli, tmp_path):
    ending = cli("-m", "hydra.sweeper.workers=0", *SHORT, "seed=0,1", f"outputs={tmp_path}/else")
    assert (
        ending.err.splitlines()[-1] == f"runner: next: `runner report {ending.folder}`, `runner table {ending.folder}`"
    )


def test_of_very_many_cells_nothing_is_compared(cli, monkeypatch):
    monkeypatch.setattr("runner.cli.run._MOST_RANKED", 1)
    ending = cli("-m", "hydra.sweeper.workers=0", "robot=macro", "duration=0.05", "seed=0,1")
    assert ending.err.splitlines()[-2] == "runner: 2 runs: 2 made, 0 stored before, none of them failed"


def test_the_choice_is_that_of_the_report(runs):
    run = runs["quintic"]
    shown = list(run_document(run).key_numbers)
    assert len(shown) == 4
    assert shown == list(key_metrics(run, 5))[:4]
