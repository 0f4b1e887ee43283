"""Actions of the queue after workers die; the engine's own tests kill them."""

import pytest
from support.short_runs import SHORT

from runner import store
from runner.config.compose.composer import Composer
from runner.config.limits import SweepConfig
from runner.sweeps.tuning.journal import Journal
from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective
from runner.sweeps.tuning.queue import TrialQueue
from runner.sweeps.tuning.study import TuningDefinition
from runner.sweeps.work import work
from runner.sweeps.writer import Rules

SETTINGS = SweepConfig(trace="auto", retry="none", on_failure="continue", attempts=1, time_limit=None, part=None)


@pytest.fixture
def queue(tmp_path):
    keys = [TunedKey("controller.natural_frequency", 5.0, 80.0, None, True, False)]
    goals = [Objective("peak_torque", "minimize")]
    study = TuningDefinition(SHORT, keys, goals, 3, "")
    store.prepare(tmp_path)
    folder = tmp_path / "tunings" / "one"
    study.write(folder, [])
    rules = Rules((), tmp_path, folder, "all", SETTINGS, True)
    return TrialQueue(study, Journal(folder / "journal.log", keys, goals), Composer(), rules, 5, 0)


def test_only_so_many_are_under_way_and_they_end_in_order(queue):
    first, second, third = (queue.take(1) for _ in range(3))
    assert queue.take(1) is None
    queue.learn(work(third))
    assert queue.take(1) is None
    assert queue.left == 5
    queue.learn(work(first))
    assert queue.left == 4
    assert queue.take(1) is not None
    queue.learn(work(second))
    assert queue.left == 2
    assert queue.take(1) is not None
    assert queue.take(1) is None


def test_a_run_whose_worker_died_is_made_alone(queue):
    chunk = queue.take(1)
    assert queue.give_back(chunk) == []
    again = queue.take_suspect()
    assert again.jobs == chunk.jobs
    queue.note(work(again).outcomes)
    assert queue.left == 4


def test_a_run_that_was_stored_before_its_worker_died_is_not_made_again(queue):
    chunk = queue.take(1)
    report = work(chunk)
    assert queue.give_back(chunk) == report.outcomes
    queue.note(report.outcomes)
    assert queue.take_suspect() is None
    assert queue.left == 4


def test_what_ended_is_told_once(queue):
    report = work(queue.take(1))
    queue.learn(report)
    queue.note(report.outcomes)
    assert queue.left == 4
