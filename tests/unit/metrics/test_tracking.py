"""Metrics of tracking errors against hand-made traces."""

import numpy as np
import pytest
from support.one_run import of_one

from runner.metrics import tracking
from runner.metrics.family import MetricContext
from runner.trajectories.circle import Circle
from runner.trajectories.goal import Goal
from runner.trajectories.motion import PathMotion, quintic_motion

evaluate = of_one(tracking)

START, END = np.zeros(3), np.array([1.0, 0.0, 0.0])
T = np.arange(401) * 0.01
TRACKED = MetricContext(quintic_motion(START, END, 3.0), 0.02, 0.01)


def test_largest_error_over_the_motion_of_the_norm_and_by_axis(hand_made_trace):
    error = np.zeros((len(T), 3))
    error[10] = [0.2, 0.1, -0.2]  # the largest norm, at another tick than the largest axis error
    error[20] = [-0.25, 0.05, 0.0]
    found = evaluate(hand_made_trace(T, tip=-error), TRACKED)
    expected = {"": 0.3, "_x": 0.25, "_y": 0.1, "_z": 0.2}
    assert {key: found[f"max_tracking_error{key}"] for key in expected} == pytest.approx(expected)
    assert found["max_axis_error"] == pytest.approx(0.25)


def test_the_root_mean_square_is_never_above_the_largest(hand_made_trace):
    tip = np.random.default_rng(0).normal(size=(len(T), 3))
    for scale in (tip, np.ones_like(tip)):
        found = evaluate(hand_made_trace(T, tip=scale), TRACKED)
        assert found["rms_tracking_error"] <= found["max_tracking_error"] * (1.0 + 1e-15)
        assert found["max_axis_error"] < found["max_tracking_error"] < 3**0.5 * found["max_axis_error"] * (1.0 + 1e-15)


@pytest.mark.parametrize(("tick", "counts"), [(0, True), (300, True), (301, False)])
def test_only_the_ticks_of_0_to_t_f_count(hand_made_trace, tick, counts):
    tip = np.zeros((len(T), 3))
    tip[tick, 1] = 0.5
    found = evaluate(hand_made_trace(T, tip=tip), TRACKED)
    assert found["max_tracking_error"] == (0.5 if counts else 0.0)
    assert found["rms_tracking_error"] == pytest.approx(0.5 / np.sqrt(301) if counts else 0.0)


def test_the_tick_at_t_f_counts_though_its_time_is_rounded(hand_made_trace):
    t, tip = np.arange(5) * 0.1, np.zeros((5, 3))
    tip[3, 2] = 0.5
    assert t[3] > 0.3
    found = evaluate(hand_made_trace(t, tip=tip), MetricContext(quintic_motion(START, END, 0.3), 0.02, 0.1))
    assert found["max_tracking_error"] == 0.5


def test_root_mean_square_of_the_norm(hand_made_trace):
    error = np.tile([0.0, 0.3, 0.4], (len(T), 1))
    error[::2] *= -1.0
    assert evaluate(hand_made_trace(T, tip=-error), TRACKED)["rms_tracking_error"] == pytest.approx(0.5)


ROUNDS = PathMotion(Circle(START, 1.0, END, np.array([0.0, 1.0, 0.0]), 1), 1.0, "none")


def test_cross_track_is_the_distance_to_the_path_whatever_the_time(hand_made_trace):
    tip = np.zeros((len(T), 3))
    tip[:, 0] = 0.5  # half-way all the time: a large error, on the path
    tip[390] = [0.5, 0.03, 0.04]  # after t_f
    for context in (TRACKED, MetricContext(Goal(START, END), 0.02, 0.01)):
        assert evaluate(hand_made_trace(T, tip=tip, desired=END), context)["cross_track_error"] == pytest.approx(0.05)


def test_a_goal_has_no_tracking_errors(hand_made_trace):
    found = evaluate(hand_made_trace(T, desired=END), MetricContext(Goal(START, END), 0.02, 0.01))
    assert found == {"cross_track_error": 0.0}


@pytest.mark.parametrize(("ticks", "counts"), [(101, True), (251, True), (100, False)])
def test_the_last_period_of_a_motion_that_repeats(hand_made_trace, ticks, counts):
    """Of 1 s, 100 ticks: an error before it does not count, and a whole period is needed."""
    t = 0.01 * np.arange(ticks)
    error = np.zeros((ticks, 3))
    error[: max(0, ticks - 100)] = [0.0, 9.0, 0.0]
    error[-100:] = [0.3, 0.0, 0.4]
    found = evaluate(hand_made_trace(t, tip=-error), MetricContext(ROUNDS, 0.02, 0.01))
    assert ("rms_tracking_error_last_period" in found) == counts
    assert not counts or found["rms_tracking_error_last_period"] == pytest.approx(0.5)


def test_periods_whose_numbers_are_powers_of_two_have_their_errors(hand_made_trace):
    """Nine periods of 1 s with the errors 1 to 9 mm, none at the last of a period's 100 ticks, which begin after it."""
    t = 0.01 * np.arange(951)
    error = np.zeros((951, 3))
    error[1:, 1] = 1e-3 * np.ceil(t[1:] - 1e-9)
    error[::100] = 0.0
    found = evaluate(hand_made_trace(t, tip=-error), MetricContext(ROUNDS, 0.02, 0.01))
    periods = {name: value for name, value in found.items() if name.startswith("rms_tracking_error_period")}
    assert periods == {f"rms_tracking_error_period_{n}": pytest.approx(1e-3 * n * np.sqrt(0.99)) for n in (1, 2, 4, 8)}


def test_a_motion_to_rest_has_no_last_period(hand_made_trace):
    assert "rms_tracking_error_last_period" not in evaluate(hand_made_trace(T, tip=np.zeros((len(T), 3))), TRACKED)
