"""One search for gains: what it tries, what it takes, and that it finds the least of a function that is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.papers.study.tune import ROUNDS, _Search
from runner.papers.study.tunings import StudyTuning, key_of

ERROR = "rms_tracking_error"


def search(ranges, bounds=None, trials=32, seed=1, longer=()):
    keys = [key_of(name, 1.0, own) for name, own in ranges.items()]
    return _Search(
        StudyTuning("arm/law", "law", (), (), ranges, ERROR, bounds or {}, trials, 3, longer),
        seed,
        keys,
        dict.fromkeys(ranges, 1.0),
    )


def a_run(status="ok", **medians):
    metrics = {name: SimpleNamespace(median=value) for name, value in medians.items()}
    return SimpleNamespace(status=status, metrics=metrics)


def test_the_first_round_begins_with_the_values_as_they_are_and_fills_the_ranges_evenly():
    start, *rest = search({"a": (0.25, 4.0), "b": (0.5, 2.0)}).proposed(0)
    assert start == {"a": 1.0, "b": 1.0}
    points = np.log2([[each["a"], each["b"]] for each in rest])
    assert points.shape == (15, 2)
    assert (np.abs(points) <= [2.0, 1.0]).all()
    # Of 15 points drawn at random one in three sets would leave a quarter of some range with one point or none.
    for axis, reach in enumerate((2.0, 1.0)):
        counts, _ = np.histogram(points[:, axis], bins=np.linspace(-reach, reach, 5))
        assert counts.min() >= 3


def test_a_search_has_its_budget_and_each_round_its_share():
    searched = search({"a": (0.25, 4.0)}, trials=10)
    tried = []
    for number in range(ROUNDS):
        tried.append(searched.proposed(number))
        for params in tried[-1]:
            searched.take(params, a_run(rms_tracking_error=abs(np.log(params["a"] / 2.0))))
    assert [len(each) for each in tried] == [5, 2, 3]
    assert all(0.25 <= params["a"] <= 4.0 for each in tried for params in each)


def test_seeds_look_elsewhere_and_one_seed_looks_at_the_same():
    one, again, other = (search({"a": (0.5, 2.0)}, seed=seed).proposed(0)[1:] for seed in (1, 1, 2))
    assert one == again
    assert not {each["a"] for each in one} & {each["a"] for each in other}


def test_without_ranges_the_values_as_they_are_are_the_one_trial():
    assert [search({}).proposed(number) for number in range(ROUNDS)] == [[{}], [], []]


def test_what_fails_or_is_beyond_a_bound_is_not_taken():
    bounded = search({"a": (0.5, 2.0)}, {"torque_chatter": 2.0})
    for value, run in enumerate(
        (
            a_run(rms_tracking_error=0.1, torque_chatter=2.1),
            a_run("failed", rms_tracking_error=0.1, torque_chatter=1.0),
            None,
            a_run(rms_tracking_error=None, torque_chatter=1.0),
        )
    ):
        bounded.take({"a": float(value)}, run)
        assert bounded.best is None
    bounded.take({"a": 9.0}, a_run(rms_tracking_error=5.0, torque_chatter=2.0))
    assert bounded.best == 4


def steady(last=1.0, error=1.0):
    """A longer run whose error is 1 after 8 and after 16 periods, and in its first ones the double."""
    periods = {f"{ERROR}_period_{number}": 1.0 if number >= 8 else 2.0 for number in (1, 2, 4, 8, 16)}
    return a_run(**{ERROR: error, f"{ERROR}_last_period": last}, **periods)


@pytest.mark.parametrize(
    ("runs", "failure"),
    [
        ([steady(), steady(1.09, 9.0)], ""),
        ([steady(), steady(1.11)], "its error grows"),
        ([steady(), steady(None)], "its error grows"),
        ([steady(error=1.09), steady()], ""),
        ([steady(error=1.11), steady()], "its error grows"),  # above what was judged
        ([steady(), None], "a repetition failed"),
        ([None, steady()], "a repetition failed"),
    ],
)
def test_the_best_trial_gives_way_where_a_longer_run_of_it_is_not_stable(runs, failure):
    searched = search({"a": (0.5, 2.0)}, longer=[("duration=40",)] * 2)
    for value in (1.0, 2.0):
        searched.take({"a": value}, a_run(rms_tracking_error=value))
    assert (searched.unproven(1), searched.unproven(8)) == ([0], [0, 1])
    searched.prove(0, runs)
    assert searched.trials[0].failure == failure
    assert (searched.best, searched.unproven(8)) == ((1, [1]) if failure else (0, []))
    searched.take({"a": 0.5}, a_run(rms_tracking_error=0.5))
    assert searched.unproven(8) == ([2, 1] if failure else [2])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_rounds_come_near_to_the_least_of_a_valley(seed):
    """The error has its least at the bound: smaller the stiffer the loop, which the bound on the chatter ends."""
    searched = search({"stiffness": (0.5, 2.0), "damping": (0.6, 1.5)}, {"torque_chatter": 1.5}, seed=seed)
    for number in range(ROUNDS):
        for params in searched.proposed(number):
            stiffness, damping = params["stiffness"], params["damping"]
            error, chatter = stiffness**-2 * (1.0 + np.log(damping) ** 2), stiffness * damping**0.25
            searched.take(params, a_run(rms_tracking_error=error, torque_chatter=chatter))
    assert len(searched.trials) == 32
    least = min(1.5**-2 * d**0.5 * (1.0 + np.log(d) ** 2) for d in np.geomspace(0.6, 1.5, 1000))
    assert least < searched.trials[searched.best].values[0] < 1.15 * least
