"""The best trials and the front against a search over all pairs."""

import itertools

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.sweeps.tuning.objective import Objective, Trial, best

LESS = Objective("settling_time", "minimize")
MORE = Objective("peak_torque", "maximize")


def trial(*values, failure=""):
    return Trial({}, values, "run", failure)


def test_of_one_objective_the_first_best_is_best():
    trials = [trial(3.0), trial(1.0), trial(1.0), trial(0.0, failure="diverged")]
    assert best(trials, [LESS]) == [1]
    assert best(trials, [MORE]) == [0]
    assert best(trials[3:], [LESS]) == []


@pytest.mark.parametrize("count", [2, 3])
def test_the_front_is_what_no_other_beats(count):
    rng = np.random.default_rng(count)
    objectives = [LESS, MORE, LESS][:count]
    values = rng.integers(0, 6, (60, count)).astype(float)
    trials = [trial(*row) for row in values.tolist()]
    losses = values * [objective.sign for objective in objectives]

    def beaten(a):
        return any((b <= a).all() and (b < a).any() for b in losses)

    expected = {tuple(values[place]) for place in range(60) if not beaten(losses[place])}
    front = best(trials, objectives)
    assert {trials[place].values for place in front} == expected
    assert len(front) == len(expected)  # each point once
    first = [trials[place].values[0] for place in front]
    assert first == sorted(first)


def test_an_unknown_metric_is_told_with_the_nearest():
    with pytest.raises(RunnerError, match=r"--minimize: unknown metric 'setling_time'"):
        Objective("setling_time", "minimize")


@pytest.mark.parametrize("metric", ["peak_torque_q1", "max_tracking_error_x", "macro_settling_time"])
def test_metrics_of_a_joint_axis_or_stage_are_known(metric):
    assert Objective(metric, "minimize").unit


def test_nothing_is_worse_than_worst():
    for objective, value in itertools.product([LESS, MORE], [-1e300, 1e300]):
        assert objective.sign * objective.worst > objective.sign * value
