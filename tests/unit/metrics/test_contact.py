"""Forces between tip and world, from hand-made wrenches whose means are known."""

from dataclasses import replace

import numpy as np
import pytest
from support.one_run import of_one

from runner.base.trace import ContactSignals
from runner.metrics import contact
from runner.metrics.contact import UNITS
from runner.metrics.family import MetricContext
from runner.trajectories.goal import Goal

evaluate = of_one(contact)

T = np.arange(101) * 0.01  # 1 s: the last half second is rows 50 to 100
STEADY = np.arange(50, 101)
CONTEXT = MetricContext(Goal(np.zeros(3), np.ones(3)), 0.02, 0.01)


def touched(hand_made_trace, external, felt=0.0, t=T):
    """Metrics of a trace with forces of the environment and measured ones; moments, reading and load are large."""

    def wrench(force):
        return np.hstack([np.zeros((len(t), 3)) + force, np.full((len(t), 3), 500.0)])

    other = np.full((len(t), 6), 700.0)
    signals = ContactSignals(wrench(external), wrench(felt), other, other, other)
    return evaluate(replace(hand_made_trace(t), contact=signals), CONTEXT)


def rows(force=(0.0, 0.0, 0.0)):
    return np.tile(np.array(force), (len(T), 1))


def test_without_contact_there_is_no_force(hand_made_trace):
    assert evaluate(hand_made_trace(T), CONTEXT) == {}


def test_the_peak_is_the_largest_magnitude_at_any_time(hand_made_trace):
    force = rows()
    force[3] = [2.0, -3.0, 6.0]  # 7 N
    force[70] = [0.0, 0.0, -6.5]
    found = touched(hand_made_trace, force, felt=40.0)
    assert found["peak_force"] == pytest.approx(7.0)


@pytest.mark.parametrize("tick", [0, 100])
def test_the_first_and_the_last_row_count_for_the_peak(hand_made_trace, tick):
    force = rows()
    force[tick, 1] = -4.0
    assert touched(hand_made_trace, force)["peak_force"] == 4.0


def test_the_steady_force_is_the_magnitude_of_the_mean(hand_made_trace):
    force = rows([3.0, 0.0, 4.0])
    force[::2, 1], force[1::2, 1] = 26.0, -25.0  # 26 even rows and 25 odd ones of the steady ones
    expected = np.array([3.0, (26 * 26.0 - 25 * 25.0) / 51, 4.0])
    assert touched(hand_made_trace, force)["steady_force"] == pytest.approx(np.linalg.norm(expected))


@pytest.mark.parametrize(("tick", "counts"), [(49, False), (50, True), (100, True)])
def test_the_steady_window_is_the_last_half_second(hand_made_trace, tick, counts):
    force, felt = rows(), rows()
    force[tick, 2], felt[tick, 0] = 51.0, 102.0
    found = touched(hand_made_trace, force, felt)
    assert found["steady_force"] == pytest.approx(1.0 if counts else 0.0)
    assert found["force_error"] == pytest.approx(np.hypot(1.0, 2.0) if counts else 0.0)


def test_the_error_is_between_the_two_means(hand_made_trace):
    # Both rise and fall within the window, and end far from their means.
    force, felt = rows([99.0] * 3), rows([-99.0] * 3)
    swing = np.linspace(-10.0, 10.0, len(STEADY))
    force[STEADY] = np.array([1.0, 2.0, 2.0]) + np.outer(swing, [1.0, -1.0, 2.0])
    felt[STEADY] = np.array([1.0, 5.0, -2.0]) + np.outer(swing, [-3.0, 1.0, 1.0])
    found = touched(hand_made_trace, force, felt)
    assert found["steady_force"] == pytest.approx(3.0)
    assert found["force_error"] == pytest.approx(5.0)


def test_what_is_felt_exactly_has_no_error(hand_made_trace):
    force = np.random.default_rng(0).normal(size=(len(T), 3))
    assert touched(hand_made_trace, force, force)["force_error"] == 0.0


def test_what_is_not_felt_at_all_is_wrong_by_the_whole_force(hand_made_trace):
    found = touched(hand_made_trace, [2.0, 3.0, 6.0])
    assert found["force_error"] == found["steady_force"] == pytest.approx(7.0)


@pytest.mark.parametrize(("ticks", "known"), [(50, False), (51, True)])
def test_a_run_shorter_than_the_window_has_a_peak_alone(hand_made_trace, ticks, known):
    found = touched(hand_made_trace, [0.0, 0.0, 2.0], t=np.arange(ticks) * 0.01)
    assert found["peak_force"] == 2.0
    assert found["steady_force"] == (pytest.approx(2.0) if known else None)
    assert found["force_error"] == (pytest.approx(2.0) if known else None)


def test_units_cover_what_is_given(hand_made_trace):
    assert set(touched(hand_made_trace, 1.0)) == set(UNITS)
