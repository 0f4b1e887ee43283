"""Proposed trials: reproducible, in range, and nearer to the least than chance."""

import math

import numpy as np
import pytest

from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, Trial
from runner.sweeps.tuning.sampler import importances, make_optuna_trial, propose, read_ended

KEYS = [
    TunedKey("x", 1e-2, 1e2, None, True, False),
    TunedKey("y", -1.0, 1.0, None, False, False),
    TunedKey("n", 1, 9, 2, False, True),
]
GOAL = [Objective("settling_time", "minimize")]
TWO = [*GOAL, Objective("peak_torque", "maximize")]


def search(function, objectives=GOAL, trials=60, seed=0, keys=KEYS):
    """Tune a closed form; it returns the values of the objectives, or None where it fails."""
    found = []
    for _ in range(trials):
        history = [make_optuna_trial(keys, trial) for trial in found]
        params = propose(keys, objectives, history, [], seed)
        values = function(params)
        worst = tuple(objective.worst for objective in objectives)
        found.append(Trial(params, worst if values is None else values, "", "failed" if values is None else ""))
    return found


def bowl(params):
    """Least at x = 10, y = 0.5."""
    return (math.log10(params["x"] / 10.0) ** 2 + (params["y"] - 0.5) ** 2,)


def test_a_proposal_follows_from_its_arguments_alone():
    history = [make_optuna_trial(KEYS, trial) for trial in search(bowl, trials=15)]
    under_way = [{"x": 1.0, "y": 0.0, "n": 3}]
    proposal = propose(KEYS, GOAL, history, under_way, 0)
    assert propose(KEYS, GOAL, history, under_way, 0) == proposal
    for other in (
        propose(KEYS, GOAL, history, under_way, 1),
        propose(KEYS, GOAL, history[1:], under_way, 0),
        propose(KEYS, GOAL, history, [], 0),
    ):
        assert other != proposal


def test_values_lie_in_range_and_on_the_grid():
    for trial in search(bowl, trials=40):
        assert 1e-2 <= trial.params["x"] <= 1e2
        assert -1.0 <= trial.params["y"] <= 1.0
        assert trial.params["n"] in (1, 3, 5, 7, 9)
        assert isinstance(trial.params["n"], int)


def test_the_first_ten_cover_a_logarithmic_range_evenly():
    params = [trial.params["x"] for seed in range(40) for trial in search(bowl, trials=10, seed=seed)]
    share = np.mean(np.array(params) < 1.0)
    assert abs(share - 0.5) < 4 * 0.5 / math.sqrt(len(params))  # four standard deviations


def test_the_search_gets_nearer_to_the_least_than_chance_does():
    gained = []
    for seed in range(5):
        values = [trial.values[0] for trial in search(bowl, trials=60, seed=seed)]
        gained.append(np.median(values[-20:]) / np.median(values[:10]))
    assert max(gained) < 0.5


def test_the_search_keeps_away_from_what_fails():
    trials = search(lambda params: None if params["y"] > 0.0 else bowl(params), trials=60)
    failed = [bool(trial.failure) for trial in trials]
    assert sum(failed[:10]) >= 2
    assert np.mean(failed[-30:]) < 0.4  # the least of what is left lies on the very edge


@pytest.mark.parametrize("objectives", [GOAL, TWO])
def test_a_search_in_which_everything_fails_goes_on(objectives):
    assert len({trial.params["x"] for trial in search(lambda _: None, objectives, trials=25)}) == 25


def test_several_objectives_are_traded_off():
    # Along x one gets better and the other worse; y is bad for both next to 0.5.
    def both(params):
        return (
            math.log10(params["x"]) + 5 * (params["y"] - 0.5) ** 2,
            math.log10(params["x"]) - 5 * abs(params["y"] - 0.5),
        )

    trials = search(both, TWO, trials=80)
    assert np.median([abs(trial.params["y"] - 0.5) for trial in trials[-30:]]) < 0.25
    assert np.ptp([math.log10(trial.params["x"]) for trial in trials[-30:]]) > 1.0


def test_a_trial_is_read_as_it_was_written():
    trial = Trial({"x": 0.1 + 0.2, "y": 0.0, "n": 3}, (-math.inf,), "abc", "diverged")
    assert read_ended(make_optuna_trial(KEYS, trial)) == trial


@pytest.mark.parametrize(("direction", "sign"), [("minimize", 1.0), ("maximize", -1.0)])
def test_the_key_that_decides_is_the_important_one(direction, sign):
    rng = np.random.default_rng(0)
    trials = []
    for _ in range(200):
        params = {"x": 10 ** rng.uniform(-2, 2), "y": rng.uniform(-1, 1), "n": int(rng.integers(0, 5)) * 2 + 1}
        trials.append(Trial(params, (0.0, sign * (params["y"] - 0.7) ** 2), "", ""))
    shares = importances(KEYS, trials, Objective("peak_torque", direction), 1)
    assert sum(shares.values()) == pytest.approx(1.0)
    assert shares["y"] > 0.9


def test_of_few_trials_no_importance_is_told():
    assert importances(KEYS, search(bowl, trials=19), GOAL[0], 0) == {}


def test_a_failed_trial_violates_a_constraint_and_no_other_does():
    good, bad = (
        make_optuna_trial(KEYS, Trial({"x": 1.0, "y": 0.0, "n": 3}, (2.0,), "a", why)) for why in ("", "failed")
    )
    assert all(value <= 0.0 for value in good.constraints.values())
    assert any(value > 0.0 for value in bad.constraints.values())
