"""The search for gains: where it looks, what it takes, and that it finds the least of a function that is known."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from runner.works.search import Tried, best, judged, proposed
from runner.works.tunings import Tuning


def tuning(ranges, bounds=None, trials=24):
    return Tuning("arm/law", (), ranges, "rms_tracking_error", bounds or {}, trials, 3)


def a_run(status="ok", **medians):
    return SimpleNamespace(status=status, metrics={name: {"median": value} for name, value in medians.items()})


def test_the_first_round_begins_with_the_values_as_they_are_and_fills_the_ranges_evenly():
    start, *rest = proposed(tuning({"a": (0.25, 4.0), "b": (0.5, 2.0)}), 1, [])
    assert start == {"a": 1.0, "b": 1.0}
    points = np.log2([[each["a"], each["b"]] for each in rest])
    assert points.shape == (24, 2)
    assert (np.abs(points) <= [2.0, 1.0]).all()
    # Points drawn at random would leave an eighth of the range empty in one case of five.
    counts, _ = np.histogram(points[:, 0], bins=np.linspace(-2.0, 2.0, 9))
    assert counts.min() >= 2


def test_the_second_round_looks_around_the_best_and_stays_within_the_ranges():
    tried = [Tried({"a": 1.0}, 0.0, 2.0), Tried({"a": 3.9}, 0.0, 1.0)]
    found = [each["a"] for each in proposed(tuning({"a": (0.25, 4.0)}), 1, tried)]
    assert len(found) == 24
    assert 3.9 / 16.0**0.125 <= min(found) < max(found) <= 4.0


def test_seeds_look_elsewhere_and_one_seed_looks_at_the_same():
    one, again, other = (proposed(tuning({"a": (0.5, 2.0)}), seed, [])[1:] for seed in (1, 1, 2))
    assert one == again
    assert not {each["a"] for each in one} & {each["a"] for each in other}


def test_without_ranges_the_values_as_they_are_are_the_one_trial():
    assert proposed(tuning({}), 1, []) == [{}]
    assert proposed(tuning({}), 1, [Tried({}, 0.0, 1.0)]) == []


def test_a_bound_comes_before_the_error_and_a_failed_run_comes_last():
    within, beyond, far = Tried({"a": 1.0}, 0.0, 5.0), Tried({"a": 2.0}, 0.1, 1.0), Tried({"a": 3.0}, 0.5, 0.5)
    failed = judged(tuning({}), {"a": 4.0}, a_run("failed", rms_tracking_error=0.1))
    assert best([failed, far, beyond, within]) is within
    assert best([failed, far, beyond]) is beyond
    assert (failed.error, judged(tuning({}), {}, None).beyond) == (math.inf, math.inf)


def test_how_far_a_metric_is_beyond_its_bound_is_told_in_shares_of_that():
    bounded = tuning({}, {"torque_chatter": 2.0, "peak_torque": 10.0})
    chattering = judged(bounded, {}, a_run(rms_tracking_error=0.1, torque_chatter=3.0, peak_torque=9.0))
    assert (chattering.beyond, chattering.error) == (pytest.approx(0.5), 0.1)
    assert judged(bounded, {}, a_run(rms_tracking_error=0.1, torque_chatter=1.0, peak_torque=9.0)).beyond == 0.0


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_two_rounds_come_near_to_the_least_of_a_valley(seed):
    """The error has its least at the bound: smaller the stiffer the loop, which the bound on the chatter ends."""
    searched, tried = tuning({"stiffness": (0.5, 2.0), "damping": (0.6, 1.5)}, {"chatter": 1.5}), []
    for _ in range(2):
        for factors in proposed(searched, seed, tried):
            stiffness, damping = factors["stiffness"], factors["damping"]
            error, chatter = stiffness**-2 * (1.0 + np.log(damping) ** 2), stiffness * damping**0.25
            tried.append(judged(searched, factors, a_run(rms_tracking_error=error, chatter=chatter)))
    assert len(tried) == 49
    least = min(1.5**-2 * d**0.5 * (1.0 + np.log(d) ** 2) for d in np.geomspace(0.6, 1.5, 1000))
    assert least < best(tried).error < 1.08 * least
