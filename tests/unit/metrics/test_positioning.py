"""Metrics of settling, steady state and overshoot against hand-made traces, at their borders too."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.one_run import of_one

from runner.metrics import positioning
from runner.metrics.family import MetricContext
from runner.metrics.positioning import UNITS
from runner.trajectories.goal import Goal
from runner.trajectories.motion import quintic_motion

evaluate = of_one(positioning)

START, GOAL = np.zeros(3), np.array([1.0, 0.0, 0.0])
PERIODIC = SimpleNamespace(start=START, goal=None, duration=1.0, tracked=True)
T = np.arange(401) * 0.01
BAND = 0.02


def context(trajectory=None):
    return MetricContext(Goal(START, GOAL) if trajectory is None else trajectory, BAND, 0.01)


def with_error(hand_made_trace, error):
    """A trace whose tip has the given error, desired minus actual, shape (T, 3) or (3,)."""
    return hand_made_trace(T, tip=GOAL - error, desired=GOAL)


def error_until(tick, size, axis=0):
    error = np.zeros((len(T), 3))
    error[: tick + 1, axis] = size
    return error


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_settled_at_the_first_tick_after_the_last_one_beyond(hand_made_trace, axis, sign):
    trace = with_error(hand_made_trace, error_until(149, sign * 0.03, axis))
    assert evaluate(trace, context())["settling_time"] == T[150]


def test_a_late_excursion_counts(hand_made_trace):
    error = error_until(100, 0.5)
    error[300, 1] = -0.021
    assert evaluate(with_error(hand_made_trace, error), context())["settling_time"] == T[301]


def test_settled_at_once(hand_made_trace):
    assert evaluate(with_error(hand_made_trace, np.zeros(3)), context())["settling_time"] == 0.0


@pytest.mark.parametrize("end", [399, 400])
def test_never_settled_means_beyond_at_the_very_end(hand_made_trace, end):
    found = evaluate(with_error(hand_made_trace, error_until(end, 0.03)), context())["settling_time"]
    assert found == (None if end == 400 else T[400])


@pytest.mark.parametrize(("size", "settled"), [(0.02, 0.0), (np.nextafter(0.02, 1.0), None)])
def test_the_band_s_border_belongs_to_it(hand_made_trace, size, settled):
    trace = hand_made_trace(T, tip=0.0, desired=[size, 0.0, 0.0])
    assert evaluate(trace, context())["settling_time"] == settled


def test_the_band_is_one_of_axes_not_of_the_norm(hand_made_trace):
    assert evaluate(with_error(hand_made_trace, np.full(3, 0.019)), context())["settling_time"] == 0.0


@pytest.mark.parametrize(("tick", "counts"), [(349, False), (350, True), (400, True)])
def test_the_steady_window_is_the_last_half_second(hand_made_trace, tick, counts):
    error = np.full((len(T), 3), 1e-3)
    error[tick, 2] = -5e-3
    found = evaluate(with_error(hand_made_trace, error), context())["steady_state_error"]
    assert found == pytest.approx(5e-3 if counts else 1e-3)


@pytest.mark.parametrize(("t_f", "known"), [(3.0, True), (3.5, True), (3.51, False), (4.0, False)])
def test_no_steady_error_with_less_than_half_a_second_after_t_f(hand_made_trace, t_f, known):
    trace = with_error(hand_made_trace, np.full(3, 1e-3))
    found = evaluate(trace, context(quintic_motion(START, GOAL, t_f)))["steady_state_error"]
    assert found == (pytest.approx(1e-3) if known else None)


def test_a_run_shorter_than_the_window_has_no_steady_error(hand_made_trace):
    trace = hand_made_trace(np.arange(50) * 0.01, desired=GOAL)
    assert evaluate(trace, context())["steady_state_error"] is None


def test_a_periodic_motion_has_neither_steady_error_nor_overshoot(hand_made_trace):
    found = evaluate(hand_made_trace(T), context(PERIODIC))
    assert found == {"settling_time": 0.0, "steady_state_error": None, "overshoot": None}


def test_overshoot_is_past_the_goal_along_the_way(hand_made_trace):
    start, goal = np.array([1.0, 1.0, 1.0]), np.array([1.0, 4.0, 5.0])  # a way of 5 along (0, 3, 4)
    tip = np.tile(start, (len(T), 1))
    tip[100] = goal + 0.1 * np.array([0.0, 0.6, 0.8]) + np.array([7.0, 0.0, 0.0])  # aside does not count
    found = evaluate(hand_made_trace(T, tip=tip, desired=goal), context(Goal(start, goal)))
    assert found["overshoot"] == pytest.approx(0.1)


def test_no_overshoot_before_the_goal_or_without_a_way(hand_made_trace):
    trace = hand_made_trace(T, tip=0.9 * GOAL, desired=GOAL)
    assert evaluate(trace, context())["overshoot"] == 0.0
    assert evaluate(trace, context(Goal(GOAL, GOAL)))["overshoot"] == 0.0


@pytest.mark.parametrize(
    ("wanted", "reached", "past"),
    [(0.0, 0.4, 0.4), (0.3, 0.4, 0.1), (0.3, 0.2, 0.0), (-0.2, 0.1, 0.1), (-0.2, -0.1, 0.0)],
)
def test_how_far_the_desired_motion_itself_goes_past_the_goal_is_no_overshoot(hand_made_trace, wanted, reached, past):
    # Both come no nearer than that, or go past the goal at x = 1 and back.
    desired, tip = (np.tile(GOAL + min(far, 0.0) * GOAL, (len(T), 1)) for far in (wanted, reached))
    desired[100], tip[120] = (1.0 + wanted) * GOAL, (1.0 + reached) * GOAL
    found = evaluate(hand_made_trace(T, tip=tip, desired=desired), context())
    assert found["overshoot"] == pytest.approx(past, abs=1e-15)


def test_units_cover_what_is_given(hand_made_trace):
    assert set(evaluate(hand_made_trace(T), context())) == set(UNITS)
