"""The first estimate of what a sweep costs."""

import numpy as np
import pytest

from runner.sweeps.grid import plan_sweep
from runner.sweeps.plan import check
from runner.sweeps.progress import estimate


def estimated(tmp_path, kept, *overrides):
    plan = plan_sweep(["robot=macro", "duration=0.05", "seed=range(0,10000)", f"outputs={tmp_path}", *overrides])
    checked = check(plan)
    cells = np.arange(len(plan))
    return estimate(plan, checked, cells, int(checked.costs.sum()), kept)


def test_runs_that_are_simulated_together_and_keep_no_trace_cost_little(tmp_path):
    assert 2.0 < estimated(tmp_path, 0.0, "plant=rk4") < 20.0


def test_a_trace_is_written_for_each_that_keeps_its_own(tmp_path):
    assert estimated(tmp_path, 1.0, "plant=rk4") == pytest.approx(100.0, rel=0.3)


def test_a_run_that_is_made_alone_has_its_fixed_cost(tmp_path):
    assert estimated(tmp_path, 0.0, "plant=default") > 100.0
