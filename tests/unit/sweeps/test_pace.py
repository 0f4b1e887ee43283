"""The first estimate of what a sweep costs."""

import contextlib
from dataclasses import replace

import numpy as np
import pytest

from runner.sweeps import run
from runner.sweeps.engine import in_process
from runner.sweeps.grid import plan_sweep
from runner.sweeps.pace import estimate
from runner.sweeps.plan import check
from runner.sweeps.run import Engine


def estimated(tmp_path, kept, *overrides):
    plan = plan_sweep(["robot=macro", "duration=0.05", "seed=range(0,10000)", f"outputs={tmp_path}", *overrides])
    checked = check(plan)
    cells = np.arange(len(plan))
    return estimate(plan, checked, cells, kept)


def test_runs_that_are_simulated_together_and_keep_no_trace_cost_little(tmp_path):
    assert 2.0 < estimated(tmp_path, 0.0, "plant=rk4") < 20.0


def test_a_trace_is_written_for_each_that_keeps_its_own(tmp_path):
    assert estimated(tmp_path, 1.0, "plant=rk4") == pytest.approx(100.0, rel=0.3)


def test_a_run_that_is_made_alone_has_its_fixed_cost(tmp_path):
    assert estimated(tmp_path, 0.0, "plant=default") > 100.0


def test_a_few_runs_of_very_many_ticks_do_not_take_the_pace_of_the_others(tmp_path):
    """As many ticks as all others have together, by runs that are compiled whole, cost next to nothing more."""
    few = ("robot=macro", "duration=1", f"outputs={tmp_path}", "trajectory=quintic")
    alone = plan_sweep([*few, "plant=mujoco", "seed=range(0,40)"])
    cells = np.arange(len(alone))
    some = estimate(alone, check(alone), cells, 1.0)

    class Both:
        """The plan with runs of many repetitions behind it."""

        def __init__(self):
            self.plans = (alone, plan_sweep([*few, "plant=rk4", "noise=thesis", "repetitions=1000", "seed=0,1"]))

        def composed(self, cell):
            return self.plans[cell >= 40].composed(cell if cell < 40 else cell - 40)

    both = Both()
    checks = [check(plan) for plan in both.plans]
    costs = np.concatenate([checked.costs for checked in checks])
    checked = replace(checks[0], costs=costs)
    assert costs[40:].sum() > 10 * costs[:40].sum()
    assert estimate(both, checked, np.arange(42), 1.0) < 3.0 * some


@pytest.mark.parametrize(("workers", "told"), [(1, "about 43 s on 1 process"), (4, "about 26 s on 4 processes")])
def test_the_time_that_is_told_has_the_start_of_the_processes_in_it(sweep, monkeypatch, capsys, workers, told):
    """40 s of simulation, and 3 s to start each process, on two cores."""
    monkeypatch.setattr(run, "local_client", lambda *_: contextlib.nullcontext())
    monkeypatch.setattr(run, "on_cluster", lambda queue, _: in_process(queue))
    monkeypatch.setattr(run, "estimate", lambda *_: 40.0)
    monkeypatch.setattr(run.os, "cpu_count", lambda: 2)
    sweep("seed=range(0,4)", "plant=rk4", engine=Engine(workers, None))
    assert told in capsys.readouterr().err
