"""A whole sweep in this process: its stored and repeated runs, and the causes that stop it."""

import errno
import json
import os
import re
import shutil
import socket
import subprocess
import threading
from contextlib import contextmanager

import numpy as np
import pytest
from support.grids import plan_sweep
from support.patience import PATIENCE

from runner import store
from runner.assembly.compiled.loops import CompiledLoops
from runner.base.errors import ConfigError, StoreError, TemporaryError
from runner.config.limits import SweepConfig
from runner.simulation.loop import InterpretedLoops
from runner.sweeps import run as execution
from runner.sweeps import work
from runner.sweeps.deadline import TimeLimitError
from runner.sweeps.estimate import Estimate
from runner.sweeps.run import Engine
from runner.sweeps.writer import one_in
from runner.symbolic.engine import evaluator

SETTINGS = SweepConfig(trace="auto", retry="none", on_failure="continue", attempts=1, time_limit=None, part=None)

DIVERGES = ("plant=rk4", "controller.singularity_damping=0", "trajectory=quintic", "duration=1")
PERIODS = "controller.period=0.01,0.06"  # the second one diverges


@contextmanager
def too_long(_):
    """Take whatever is done within as longer than its limit."""
    yield
    raise TimeLimitError


def runs(ended):
    return list(store.open_sweep(ended.folder).runs())


def test_what_is_stored_is_not_made_again(sweep, simulated_runs):
    first = sweep("seed=0,1")
    assert len(simulated_runs) == 2
    second = sweep("seed=0,1")
    assert len(simulated_runs) == 2
    assert second == first
    assert [run.config["seed"] for run in runs(sweep("seed=0,1,2"))] == [0, 1, 2]
    assert len(simulated_runs) == 3


def test_cells_of_one_config_are_one_run(sweep, simulated_runs):
    ended = sweep("seed=1,1", "preset=full_equations")
    assert len(simulated_runs) == 1
    assert len(runs(ended)) == 2


@pytest.mark.parametrize("damage", ["metrics.json", "trace.parquet", "config.yaml", "robot.urdf"])
@pytest.mark.parametrize("how", ["gone", "half"])
def test_a_half_written_run_is_made_again(sweep, simulated_runs, damage, how):
    ended = sweep("seed=0,1")
    path = runs(ended)[1].folder / damage
    whole = path.read_bytes()
    path.unlink() if how == "gone" else path.write_bytes(
        whole[: len(whole) // 2 if damage in ("metrics.json", "trace.parquet") else 0]
    )
    sweep("seed=0,1")
    assert len(simulated_runs) == 3
    assert path.stat().st_size == pytest.approx(len(whole), abs=100)  # times have other digits


def test_a_failed_run_is_made_again_only_when_asked(sweep, simulated_runs):
    first = sweep(*DIVERGES, PERIODS)
    assert len(simulated_runs) == 2
    ((overrides, why, where),) = first.failures
    assert overrides[-1] == "controller.period=0.06"
    assert why.startswith("failed in repetition 0 at t = 0.6 s (q1): diverged")
    assert json.loads(where.read_text())["status"] == "failed"
    assert sweep(*DIVERGES, PERIODS).failures == first.failures
    assert len(simulated_runs) == 2
    assert sweep(*DIVERGES, PERIODS, "sweep.retry=failed").failures[0][1] == why
    assert len(simulated_runs) == 3


@pytest.mark.costs(2)
def test_a_sweep_may_stop_at_the_first_failure_and_go_on_later(sweep, simulated_runs):
    overrides = (*DIVERGES, "controller.period=0.06", "controller.natural_frequency=30,5,6,7")  # the first one does
    ended = sweep(*overrides, "sweep.on_failure=stop")
    assert (len(simulated_runs), len(ended.failures), ended.left) == (1, 1, 3)
    ended = sweep(*overrides)
    assert (len(runs(ended)), len(ended.failures), ended.left) == (4, 1, 0)


@pytest.mark.costs(2)
def test_traces_are_kept_as_asked_and_metrics_always(sweep, tmp_path):
    everything = runs(sweep(*DIVERGES, "controller.period=0.01,0.06,0.02"))
    for policy, folders in (("all", 3), ("failed", 1), ("never", 0)):
        asked = (f"sweep.trace={policy}", f"outputs={tmp_path}/{policy}")
        ended = sweep(*DIVERGES, "controller.period=0.01,0.06,0.02", *asked)
        found = runs(ended)
        assert len([*(tmp_path / policy / "runs").iterdir()]) == folders, policy
        for run, whole in zip(found, everything, strict=True):
            assert run.hash == whole.hash
            assert run.metrics == whole.metrics
            assert run.failure == whole.failure
            assert run.urdf == whole.urdf
            assert store.simulated_part(run.config) == store.simulated_part(whole.config)
        for run in [run for run in found if not run.folder.exists()]:
            with pytest.raises(StoreError, match=r"kept no trace \(sweep\.trace\); this simulates it again with one: "):
                _ = run.trace()
    assert "more in" not in ended.failures[0][2].read_text()  # that of the last policy, "never"
    assert "diverged" in ended.failures[0][2].read_text()


def test_one_in_a_hundred_is_sampled(tmp_path):
    rules = work.Rules((), tmp_path, tmp_path, "sample", SETTINGS, True)
    kept = sum(rules.keeps_trace(f"{np.random.default_rng(n).bytes(12).hex()}", False) for n in range(5000))
    assert 30 <= kept <= 70
    assert all(rules.keeps_trace(f"{n:024x}", True) for n in range(20))


@pytest.mark.parametrize(("runs", "expected"), [(1, 100), (20_000, 100), (20_001, 200), (10**6, 5000), (10**7, 50_000)])
def test_the_sample_of_a_very_large_sweep_is_no_larger_than_that_of_a_large_one(runs, expected):
    assert one_in(runs) == expected
    assert runs / expected <= 200


def test_the_sample_of_a_larger_sweep_is_part_of_that_of_a_smaller_one(tmp_path):
    small, large = (
        work.Rules((), tmp_path, tmp_path, "sample", SETTINGS, True, one_in(runs)) for runs in (10**4, 10**6)
    )
    names = [f"{number:024x}" for number in range(20_000)]
    kept = [name for name in names if large.keeps_trace(name, False)]
    assert len(kept) == 4
    assert all(small.keeps_trace(name, False) for name in kept)
    assert (small.kept, large.kept) == (0.01, 0.0002)


def test_failures_in_shards_are_made_again_whatever_the_clock_says(sweep, simulated_runs, tmp_path, monkeypatch):
    """The clock was ahead when the first shards were written; their names have nothing of it."""
    given = ("seed=1,2", "duration=10", "sweep.trace=never")
    with monkeypatch.context() as patch:
        patch.setattr(work, "deadline", too_long)
        first = sweep(*given, "sweep.time_limit=30")
    assert [why.startswith("cut short") for _, why, _ in first.failures] == [True, True]
    for path in (tmp_path / "outputs" / "shards").iterdir():
        path.rename(path.with_name(f"0{9 * 10**18}-{path.name.partition('-')[2]}"))
    again = sweep(*given, "sweep.retry=failed")
    assert (again.failures, len(simulated_runs)) == ([], 4)
    assert [run.status for run in runs(again)] == ["ok", "ok"]
    assert sweep(*given, "sweep.retry=failed").failures == []
    assert len(simulated_runs) == 4


def test_a_run_in_a_shard_counts_unless_its_trace_is_wanted(sweep, simulated_runs):
    sweep("seed=0,1", "sweep.trace=never")
    sweep("seed=0,1", "sweep.trace=never")
    assert len(simulated_runs) == 2
    ended = sweep("seed=0,1", "sweep.trace=all")
    assert len(simulated_runs) == 4
    assert all(len(run.trace()) > 1 for run in runs(ended))


@pytest.mark.costs(2)
@pytest.mark.usefixtures("a_limit_of_ticks")
def test_a_run_that_takes_too_long_is_cut_short(sweep, simulated_runs):
    ticked = "robot.friction.coulomb=0.5"  # its ticks are interpreted, else it may end before the limit
    ended = sweep("duration=1e4,0.05", ticked, "sweep.time_limit=30", "sweep.attempts=2")
    ((overrides, why, log),) = ended.failures
    assert "duration=10000.0" in overrides
    assert why == "cut short: no result within sweep.time_limit, 30 s"
    assert log.read_text().startswith("runner robot=macro duration=10000.0")
    long, short = runs(ended)
    assert (long.status, dict(long.metrics), short.status) == ("failed", {}, "ok")
    assert sweep("duration=1e4,0.05", ticked, "sweep.time_limit=30").failures == ended.failures
    assert len(simulated_runs) == 2  # it is not tried again


def test_an_error_of_a_part_is_a_failed_run_with_its_traceback(sweep, monkeypatch, simulated_runs):
    calls = []

    def fall_over(self, *_):
        calls.append(1)
        if len(calls) == 1:
            raise RuntimeError("a bug")
        return update(self, *_)

    part = CompiledLoops if evaluator() else InterpretedLoops
    update = part.update
    monkeypatch.setattr(part, "update", fall_over)
    monkeypatch.setattr("runner.sweeps.run.estimate", lambda *_: Estimate(1.0))
    ticked = "robot.friction.coulomb=0.5"  # its ticks are interpreted
    ended = sweep("seed=0,1", ticked)
    ((_, why, log),) = ended.failures
    assert re.fullmatch(r"cut short: RuntimeError: a bug \(test_run.py, line \d+, in fall_over\)", why)
    assert "Traceback" in log.read_text()
    assert "in fall_over" in log.read_text()
    calls.clear()
    assert sweep("seed=0,1", ticked, "sweep.retry=failed", "sweep.attempts=3").failures == []


def test_an_invalid_cell_is_named_before_anything_starts(sweep, tmp_path, simulated_runs):
    with pytest.raises(ConfigError) as raised:
        sweep("noise.position=1e-4,-1,1e-3", "seed=0,1")
    (problem,) = raised.value.problems
    assert problem.endswith("noise.position=-1 seed=0] and 1 other cell: noise.position: must be 0 or more; found -1")
    assert "nothing was started" in str(raised.value)
    assert (simulated_runs, list(tmp_path.iterdir())) == ([], [])


def test_a_problem_that_only_assembly_shows_is_named_before_anything_starts(sweep, simulated_runs):
    with pytest.raises(ConfigError, match=r"plant\.wrist_rotation: parallel leaves"):
        sweep("robot=combined,macro", "plant.wrist_rotation=parallel", "controller.wrist_rotation=real")
    assert simulated_runs == []


def test_many_problems_are_counted(sweep):
    with pytest.raises(ConfigError, match=r"and 5 more problems; nothing was started"):
        sweep("noise.position=range(-25,0)")


def test_outputs_are_one_folder_for_all(sweep, tmp_path):
    with pytest.raises(ConfigError, match="must have one value in all runs of a sweep"):
        sweep(f"outputs={tmp_path}/a,{tmp_path}/b")


@pytest.mark.parametrize("trace", ["all", "never"])
@pytest.mark.parametrize("second", ["seed=0,1", "seed=2,3", "seed=1,2"], ids=["equal", "disjoint", "overlapping"])
def test_a_second_sweep_begins_and_ends_while_the_first_is_at_work(sweep, threads, monkeypatch, trace, second):
    begun, done = threading.Event(), threading.Event()
    begin = execution.find_stored

    def wait(*arguments):
        found = begin(*arguments)
        if not begun.is_set():
            begun.set()
            assert done.wait(PATIENCE)
        return found

    monkeypatch.setattr(execution, "find_stored", wait)
    keep = f"sweep.trace={trace}"
    first = threads.submit(sweep, "seed=0,1", keep)
    assert begun.wait(PATIENCE)
    ended = sweep(second, keep)
    assert (ended.left, len(runs(ended))) == (0, 2)
    done.set()
    assert (first.result(PATIENCE).left, len(runs(first.result(PATIENCE)))) == (0, 2)
    for seeds, count in (("seed=0,1", 2), ("seed=0,1,2,3", len({0, 1, *map(int, second[5:].split(","))}))):
        assert sweep(seeds, keep).stored == count


@pytest.mark.parametrize("trace", ["all", "never"])
def test_a_full_disk_stops_the_sweep_which_goes_on_later(sweep, simulated_runs, monkeypatch, tmp_path, trace):
    fsync, calls = os.fsync, []

    def fill_up(file):
        calls.append(file)
        if len(calls) > (8 if trace == "all" else 4):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(file)

    monkeypatch.setattr(os, "fsync", fill_up)
    with pytest.raises(
        TemporaryError, match="No space left on device; free space on its disk; finished runs are stored; the"
    ):
        sweep("seed=range(0,40)", f"sweep.trace={trace}")
    monkeypatch.undo()
    ended = sweep("seed=range(0,40)", f"sweep.trace={trace}")
    assert len(runs(ended)) == 40
    assert [path for path in tmp_path.rglob("*") if path.name.startswith(".")] == []


def test_a_copied_sweep_opens_elsewhere(sweep, tmp_path):
    ended = sweep("seed=range(0,3)", "sweep.trace=never")
    copy = shutil.copytree(tmp_path / "outputs", tmp_path / "elsewhere")
    shutil.rmtree(tmp_path / "outputs")
    opened = store.open_sweep(copy / "sweeps" / ended.folder.name)
    assert [run.config["seed"] for run in opened.runs()] == [0, 1, 2]


def test_what_killed_processes_left_is_removed_from_runs_that_are_stored_too(sweep, tmp_path):
    ended = sweep("seed=0,1")
    host, dead = socket.gethostname(), subprocess.Popen(["true"])
    dead.wait(PATIENCE)
    for folder in (runs(ended)[0].folder, ended.folder, ended.folder / "scratch-1234"):
        folder.mkdir(exist_ok=True)
        (folder / f".metrics.json.{host}.{dead.pid}.tmp").touch()
    assert sweep("seed=0,1") == ended
    assert [path for path in tmp_path.rglob("*") if path.name.startswith(".") or path.name.startswith("scratch")] == []


@pytest.mark.parametrize("workers", [-1, 1.5, "two", True])
def test_a_number_of_workers_that_is_none_is_said(workers):
    with pytest.raises(ConfigError, match=r"hydra.sweeper.workers: must be a whole number, 0 or more; found"):
        Engine(workers, None)


def test_more_than_some_thousand_runs_are_sampled(sweep, monkeypatch, tmp_path):
    monkeypatch.setattr("runner.sweeps.run._ALL_TRACES_UP_TO", 4)
    sweep("seed=range(0,4)")
    assert len([*(tmp_path / "outputs" / "runs").iterdir()]) == 4
    ended = sweep("seed=range(10,30)")
    assert len([*(tmp_path / "outputs" / "runs").iterdir()]) < 10
    assert [run.config["seed"] for run in runs(ended)] == [*range(10, 30)]


def test_plans_stay_small(tmp_path):
    plan = plan_sweep(["robot=macro", "seed=range(0,100000)", f"outputs={tmp_path}"])
    assert len(plan) == 100_000
    assert plan.composed(99_999).resolved["seed"] == 99_999
