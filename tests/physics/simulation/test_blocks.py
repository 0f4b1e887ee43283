"""Repetitions of a run in blocks and on threads against all of them at once."""

import functools
import threading

import numpy as np
import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.simulation import run as simulation
from runner.simulation.batch import BatchSimulator
from runner.simulation.run import MOST_THREADS, simulate_blocks
from runner.sweeps.records import make_record
from runner.symbolic.engine import evaluator

pytestmark = pytest.mark.skipif(not evaluator(), reason="runs are compiled as a whole by llvmlite")
SCENE = "robot=macro", "plant=rk4", "controller=operational_space", "noise=thesis", "torque_limits=thesis"
FAILING = (
    "trajectory=goal", "duration=0.3", "noise.position=0.1", "controller.natural_frequency=30", "torque_limits=none"
)  # fmt: skip


def job(*overrides):
    return validate(compose([*SCENE, *overrides]))


@functools.cache
def at_once(*overrides):
    """Return a job and all of its repetitions in one block."""
    given = job(*overrides)
    return given, simulate_blocks(given)


def record(result):
    return {key: value for key, value in make_record(result).items() if key not in ("timing", "provenance")}


@pytest.mark.parametrize(
    "overrides",
    [
        ("trajectory=quintic", "duration=0.5", "noise.position=0.05"),  # caveats of several joints and repetitions
        FAILING,
        ("trajectory=quintic", "duration=0.1", "mismatch.spread=0.1"),
        ("trajectory=quintic", "duration=0.1", "mismatch.link.link2.inertia_spread=0.9", "controller=adaptive"),
        ("robot=combined", "controller=macro_mini", "duration=0.1"),
    ],
    ids=["caveats", "failures", "beliefs", "link", "combined"],
)
@pytest.mark.parametrize(("ticks", "threads"), [(1, 3), (250, 1), (250, 2), (900, 5)])
def test_blocks_and_threads_change_nothing(overrides, ticks, threads):
    given, whole = at_once(*overrides, "repetitions=45")
    parted = simulate_blocks(given, threads, ticks)
    assert record(parted) == record(whole)
    for name, values in vars(whole.trace).items():
        if isinstance(values, np.ndarray) and name != "tick_seconds":
            assert np.array_equal(getattr(parted.trace, name), values), name
    assert parted.timing["wall_s"] > 0.0
    assert parted.timing["cpu_s"] > 0.0


def test_the_first_repetition_that_fails_is_told_whichever_block_it_is_in():
    given = job(*FAILING, "repetitions=45")
    whole = simulate_blocks(given)
    lost = np.flatnonzero(np.isnan(whole.metrics["energy"].values))
    assert 0 < len(lost) < 45  # else the test says nothing
    assert whole.failure[0] == lost[0] > 0
    assert simulate_blocks(given, 2, 1).failure == whole.failure


def test_no_block_is_larger_than_asked_for(monkeypatch):
    """Whatever the number of repetitions: that bounds the memory."""
    asked, simulate = [], BatchSimulator.simulate

    def noted(self, runs):
        asked.append((len(runs), threading.current_thread()))
        return simulate(self, runs)

    monkeypatch.setattr(BatchSimulator, "simulate", noted)
    config = job("trajectory=quintic", "duration=0.1", "repetitions=95")
    simulate_blocks(config, threads=2, ticks=10 * config.timing.ticks)
    assert sorted(size for size, _ in asked) == [5, *[10] * 9]
    assert len({thread for _, thread in asked}) == 3  # this one, and two more
    asked.clear()
    simulate_blocks(config, threads=2, ticks=config.timing.ticks - 1)
    assert asked == [(1, threading.main_thread())] * 95


def test_an_error_in_a_block_ends_the_run_and_its_threads(monkeypatch):
    simulate = BatchSimulator.simulate

    def failing(self, runs):
        if runs[0].repetition == 30:
            raise OSError("the disk is gone")
        return simulate(self, runs)

    monkeypatch.setattr(BatchSimulator, "simulate", failing)
    before = threading.active_count()
    config = job("trajectory=quintic", "duration=0.1", "repetitions=95")
    with pytest.raises(OSError, match="the disk is gone"):
        simulate_blocks(config, threads=2, ticks=10 * config.timing.ticks)
    assert threading.active_count() == before


def test_parts_of_the_user_s_are_asked_by_one_thread_alone(monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 64)
    monkeypatch.delattr("os.sched_getaffinity", raising=False)
    assert simulation.threads_allowed() == MOST_THREADS
    monkeypatch.setattr(simulation, "has_users_parts", lambda: True)
    assert simulation.threads_allowed() == 1


def test_what_is_not_compiled_as_a_whole_is_left_to_the_loop():
    assert simulate_blocks(job("plant=kinematic", "controller=differential_inverse_kinematics", "noise=none",
                               "torque_limits=none", "repetitions=5")) is None  # fmt: skip
