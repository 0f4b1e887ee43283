"""Ticks counted next to the simulation."""

import threading

import numpy as np
import pytest
from support.patience import PATIENCE

from runner.assembly.validation import validate
from runner.base import ticks
from runner.config.compose.compose import compose
from runner.simulation.run import simulate_run


def test_those_of_a_repetition_under_way_count():
    clock = np.zeros(101, dtype=np.int64)
    count = ticks.counter()
    with ticks.track_ticks(clock, 100):
        clock[:30] = 7
        assert count() == 30
    assert count() == 100
    ticks.add_ticks(5)
    assert count() == 105


def test_a_repetition_that_ends_early_counts_as_made():
    count = ticks.counter()
    with pytest.raises(ValueError, match="diverged"), ticks.track_ticks(np.zeros(11, dtype=np.int64), 10):
        raise ValueError("diverged")
    assert count() == 10


@pytest.mark.parametrize("plant", ["rk4", "mujoco"])
def test_a_run_counts_the_ticks_of_all_its_repetitions(plant):
    """Compiled as a whole, or tick by tick."""
    config = validate(compose(["robot=macro", f"plant={plant}", "duration=0.1", "repetitions=3"]))
    count = ticks.counter()
    simulate_run(config)
    assert count() == 3 * config.timing.ticks


def test_they_are_told_from_a_thread_that_ends_with_the_work(monkeypatch):
    monkeypatch.setattr(ticks, "_EVERY", 0.001)
    told, enough = [], threading.Event()

    def tell(count):
        told.append((count, threading.current_thread()))
        enough.set()

    with ticks.report_ticks(tell):
        ticks.add_ticks(3)
        assert enough.wait(PATIENCE)
    count, thread = told[-1]
    assert count == 3 or told[0][0] == 0
    assert thread is not threading.current_thread()
    assert not thread.is_alive()


def test_nobody_is_told_where_nobody_asks():
    before = threading.active_count()
    with ticks.report_ticks(None):
        assert threading.active_count() == before
