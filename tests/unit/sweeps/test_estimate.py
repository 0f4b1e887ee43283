"""Estimate of what a sweep costs: the paces of probes are given, and the clock of the note is a test's own."""

import contextlib
import json
from types import SimpleNamespace

import numpy as np
import pytest

from runner.sweeps import estimate as pace
from runner.sweeps.deadline import TimeLimitError
from runner.sweeps.estimate import Pace, estimate
from runner.sweeps.status import read_pace

TICKS, RUNS = 200, 30


class Plan:
    """Runs whose configs are their numbers."""

    def composed(self, cell):
        return SimpleNamespace(resolved=cell)


@pytest.fixture
def estimated(monkeypatch):
    """Estimate runs with paces given in turn, single or together, by their kept share and their time limit."""

    def make(*paces, together=False, kept=0.0, limit=None, costs=(TICKS,) * RUNS, calibrations=()):
        def found(job, *_):
            told = paces[job % len(paces)] if len(paces) < len(costs) else paces[job]
            if isinstance(told, BaseException):
                raise told
            return told

        monkeypatch.setattr(pace, "validate", lambda composed: composed.resolved)

        def found_together(job, ticks, _):
            make.ticks.append(ticks)
            return found(job) if together else None

        monkeypatch.setattr(pace, "seconds_together", found_together)
        monkeypatch.setattr(pace, "seconds_per_tick", found)
        checked = SimpleNamespace(
            costs=np.array(costs),
            calibrations=calibrations,
            first=SimpleNamespace(sweep=SimpleNamespace(time_limit=limit)),
        )
        return estimate(Plan(), checked, np.arange(len(costs)), kept)

    make.ticks = []  # that each probe was to make of runs together
    return make


def of_ticks(found, none):
    """Return the time of ticks without the fixed cost of runs, in s."""
    return found.seconds - none.seconds


def test_it_is_the_pace_of_a_tick_times_all_ticks_beside_what_runs_cost_anyway(estimated):
    assert estimated(1e-3).known == "about"
    assert of_ticks(estimated(1e-3), estimated(0.0)) == pytest.approx(1e-3 * RUNS * TICKS)
    assert estimated(0.0).seconds > 0.0


@pytest.mark.parametrize("slow", range(3))
def test_one_slow_probe_of_three_does_not_count(estimated, slow):
    paces = [1e-6] * 3
    paces[slow] = 1.0
    by_run = [paces[run * 3 // RUNS] for run in range(RUNS)]
    assert estimated(*by_run) == estimated(1e-6)


@pytest.mark.parametrize("late", range(3))
def test_one_probe_of_three_that_is_late_does_not_count(estimated, late):
    paces = [1e-6] * 3
    paces[late] = TimeLimitError()
    by_run = [paces[run * 3 // RUNS] for run in range(RUNS)]
    assert estimated(*by_run) == estimated(1e-6)
    assert estimated(*by_run, limit=7.0) == estimated(1e-6)


def test_of_two_probes_the_slower_one_counts(estimated):
    two = (TICKS, TICKS)
    assert estimated(1e-6, 1.0, costs=two) == estimated(1.0, costs=two) == estimated(1.0, 1e-6, costs=two)


def test_what_is_late_takes_up_to_the_time_limit_of_each_run(estimated):
    found = estimated(TimeLimitError(), limit=7.0)
    assert found.known == "up to"
    assert of_ticks(found, estimated(0.0)) == pytest.approx(7.0 * RUNS)


def test_what_is_late_without_a_limit_takes_more_than_the_time_of_a_probe_for_as_many_ticks(estimated):
    found, longer = estimated(TimeLimitError()), estimated(TimeLimitError(), costs=(2 * TICKS,) * RUNS)
    assert found.known == longer.known == "more than"
    assert of_ticks(longer, estimated(0.0)) == pytest.approx(2.0 * of_ticks(found, estimated(0.0)))
    assert of_ticks(found, estimated(0.0)) > 0.0


def test_a_bound_of_some_runs_bounds_all(estimated):
    costs = (10,) * 3 + (1000,) * 3
    paces = [1e-6] * 3 + [TimeLimitError()] * 3
    assert estimated(*paces, costs=costs).known == "more than"
    assert estimated(*paces, costs=costs, limit=1.0).known == "up to"


def test_runs_of_other_powers_of_ten_of_ticks_have_a_pace_of_their_own(estimated):
    costs = (TICKS,) * 3 + (100 * TICKS,) * 3
    found = estimated(1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6, costs=costs)
    assert found.known == "about"
    assert of_ticks(found, estimated(0.0, costs=costs)) == pytest.approx(3 * TICKS * 1e-3 + 300 * TICKS * 1e-6)


@pytest.mark.parametrize(("runs", "ticks"), [(2, 2 * TICKS), (100, 100 * TICKS), (101, 100 * TICKS)])
def test_a_probe_of_runs_together_makes_no_more_ticks_than_they_have_nor_than_its_most(estimated, runs, ticks):
    estimated(1e-6, together=True, costs=(TICKS,) * runs)
    assert set(estimated.ticks) == {ticks}


@pytest.mark.parametrize("together", [True, False])
def test_the_deadline_is_left_to_the_measurement_which_first_assembles(estimated, monkeypatch, together):
    entered = []

    @contextlib.contextmanager
    def deadline(seconds):
        entered.append(seconds)
        yield

    monkeypatch.setattr(pace, "deadline", deadline)
    estimated(1e-6, together=together)
    assert entered == []


def test_runs_made_together_cost_less_unless_each_keeps_its_trace(estimated):
    alone, kept, half, none = (
        estimated(0.0, together=together, kept=share).seconds
        for together, share in ((False, 0.0), (True, 1.0), (True, 0.5), (True, 0.0))
    )
    assert none < 0.1 * kept
    assert half == pytest.approx(0.5 * (kept + none))
    assert kept == alone == estimated(0.0, kept=1.0).seconds


def test_what_fails_in_a_probe_and_what_is_calibrated_costs_no_ticks(estimated):
    assert estimated(ValueError("a bug")) == estimated(0.0)
    assert estimated(1e-3, calibrations=range(RUNS)) == estimated(0.0, calibrations=range(RUNS))
    half = estimated(1e-3, calibrations=range(RUNS // 2))
    assert of_ticks(half, estimated(0.0)) == pytest.approx(1e-3 * TICKS * (RUNS - RUNS // 2))


def test_the_note_tells_the_time_for_a_job_by_the_clock_once_some_time_has_passed(tmp_path):
    now = 100.0
    noted = Pace(tmp_path, clock=lambda: now)
    noted.add(5)
    assert read_pace(tmp_path) is None
    now = 130.0
    noted.add(5)
    assert read_pace(tmp_path) == 3.0
    noted.add(90)  # at once: it stays
    assert read_pace(tmp_path) == 3.0
    now = 150.0
    noted.add(0)
    assert read_pace(tmp_path) == 0.5
    assert json.loads(next(tmp_path.iterdir()).read_text())["seconds_per_run"] == 0.5
