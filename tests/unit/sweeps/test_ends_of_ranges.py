"""Best values at the end of a range: named for one best trial and for a front, silent between the ends."""

from pathlib import Path

import pytest

from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, Trial
from runner.sweeps.tuning.study import Tuning, TuningDefinition, at_ends

RATIO = TunedKey("controller.damping_ratio", 0.5, 1.5, None, False, False)
GOALS = [Objective("peak_torque", "minimize"), Objective("rms_torque", "minimize")]


def tuning(values, objectives):
    """Return a tuning whose trial n has the n-th value, and losses by which the later ones win in all but the first."""
    study = TuningDefinition([], [RATIO], objectives, 1, "")
    losses = [(float(n), -float(n))[: len(objectives)] for n in range(len(values))]
    return Tuning(Path(), study, [Trial({RATIO.name: v}, loss, "", "") for v, loss in zip(values, losses, strict=True)])


@pytest.mark.parametrize(("best", "end"), [(0.5, "lower"), (0.519, "lower"), (1.49, "upper")])
def test_the_best_value_at_an_end_is_named(best, end):
    assert at_ends(tuning([best, 1.5], GOALS[:1])) == [
        f"controller.damping_ratio: the chosen value, {best:.3g}, lies within 2 % of the {end} end of its range "
        "(0.5 to 1.5). A wider range may give a better one."
    ]


def test_between_the_ends_and_without_a_good_trial_there_is_nothing_to_say():
    assert at_ends(tuning([0.6, 0.5], GOALS[:1])) == []
    assert at_ends(tuning([], GOALS[:1])) == []


def test_of_a_front_the_values_at_each_end_are_counted():
    lower, upper = at_ends(tuning([0.5, 1.0, 0.51, 1.5], GOALS))
    assert "2 of 4 chosen values lie within 2 % of the lower end" in lower
    assert "1 of 4 chosen values lie within 2 % of the upper end" in upper
