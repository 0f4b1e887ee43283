"""Fraction of ticks with x_d out of reach: by the distance from the last stage's base."""

from dataclasses import replace

import numpy as np
import pytest
from support.one_run import of_one

from runner.metrics import reaching
from runner.metrics.family import MetricContext
from runner.metrics.reaching import UNITS
from runner.trajectories.goal import Goal

evaluate = of_one(reaching)

REACH = 0.2
T = np.arange(10) * 0.01
ALONG = np.array([2.0, -1.0, 2.0]) / 3.0


def context(reach=REACH):
    return MetricContext(Goal(np.zeros(3), np.ones(3)), 0.02, 0.01, reach)


def make_trace(hand_made_trace, desired, *end_points):
    """A trace of stages whose end points are given, one after another, each a place or a row for each tick."""
    names = ("macro", "mini", "mini2")[: len(end_points)]
    rows = np.array([np.zeros((len(T), 3)) + point for point in end_points])
    return replace(hand_made_trace(T, desired=desired), end_points=rows, stage_names=names)


def lost(*arguments):
    return evaluate(make_trace(*arguments), context())["reach_loss_fraction"]


def away(distances):
    """Places at distances from the origin, along one direction, or each in a row."""
    return np.multiply.outer(distances, ALONG)


def test_the_share_of_ticks_with_the_target_beyond_reach_of_the_base(hand_made_trace):
    base = np.array([0.3, 0.4, 0.5])
    distances = np.array([0.0, 0.1, 0.19, 0.21, 0.3, 0.1, 5.0, 0.0, 0.0, 0.0])
    target = base + away(distances)
    # The tip is where it is wanted, then far off: neither has a say.
    for tip in (target, np.full(3, 9.0)):
        assert lost(hand_made_trace, target, base, tip) == 3 / 10


def test_a_tip_that_lags_has_lost_nothing_while_its_base_is_near(hand_made_trace):
    base, tip = np.zeros(3), away(-0.15)
    assert lost(hand_made_trace, away(0.15), base, tip) == 0.0


def test_the_base_moves(hand_made_trace):
    base = away(np.linspace(0.0, 0.9, len(T)))  # 0.1 m a tick, past the target at 0.45 m
    assert lost(hand_made_trace, away(0.45), base, np.zeros(3)) == 6 / 10


@pytest.mark.parametrize(("distance", "share"), [(np.nextafter(REACH, 0.0), 0.0), (REACH, 0.0), (0.2 + 1e-12, 1.0)])
def test_the_border_is_within_reach(hand_made_trace, distance, share):
    assert lost(hand_made_trace, [distance, 0.0, 0.0], np.zeros(3), np.zeros(3)) == share


def test_of_three_stages_the_last_one_s_base_counts(hand_made_trace):
    target, far, near = away(0.5), np.zeros(3), away(0.4)
    assert lost(hand_made_trace, target, far, near, target) == 0.0
    assert lost(hand_made_trace, target, near, far, target) == 1.0


def test_one_stage_or_no_reach_has_no_such_number(hand_made_trace):
    assert evaluate(make_trace(hand_made_trace, np.ones(3), np.zeros(3)), context()) == {}
    assert evaluate(make_trace(hand_made_trace, np.ones(3), np.zeros(3), np.zeros(3)), context(None)) == {}


def test_units_cover_what_is_given(hand_made_trace):
    assert set(evaluate(make_trace(hand_made_trace, np.ones(3), np.zeros(3), np.zeros(3)), context())) == set(UNITS)
