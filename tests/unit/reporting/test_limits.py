"""Metrics at a torque limit: which are not compared, and which joint is named."""

from dataclasses import replace

import numpy as np
import pytest
from support.sample_sweep import measurements

from runner.reporting.limits import FOLLOWING, PEAKS, describe_limit, find_limit, is_saturated, limiting_joint

AXES = {"controller": ["a", "b"]}


def sides(share, threshold=None, **metrics):
    """Return two cells; in the second one, joint 2 is at its limit of 87 N m at some ticks."""
    values = {
        "saturation_fraction": lambda law: np.array([0.0, share if law else 0.0]),
        "saturation_fraction_q1": lambda law: np.zeros(2),
        "saturation_fraction_q2": lambda law: np.array([0.0, share if law else 0.0]),
        "peak_torque_q2": lambda law: np.array([50.0, 87.0]),
        **metrics,
    }
    sample = measurements(AXES, values)
    if threshold is not None:
        sample = replace(sample, configs=[({"caveats": {"saturation": {"share": threshold}}}, np.arange(2))])
    return [(sample, np.array([0])), (sample, np.array([1]))]


@pytest.mark.parametrize("metric", PEAKS)
def test_one_tick_at_a_limit_makes_the_largest_torque_no_result(metric):
    assert find_limit(sides(1e-4), metric) == "joint 2 is at its limit of 87 N m at up to 0.01 % of the ticks"
    assert find_limit(sides(0.0), metric) == ""


@pytest.mark.parametrize("metric", FOLLOWING)
@pytest.mark.parametrize("threshold", [None, 0.3])
def test_what_follows_from_torque_counts_up_to_the_threshold_of_the_caveat(metric, threshold):
    limit = threshold or 0.1
    assert find_limit(sides(limit, threshold), metric) == ""
    assert find_limit(sides(np.nextafter(limit, 1.0), threshold), metric).startswith("joint 2 is at its limit")
    assert is_saturated(sides(np.nextafter(limit, 1.0), threshold))
    assert not is_saturated(sides(limit, threshold))


def test_a_joint_is_judged_by_its_own_ticks():
    assert find_limit(sides(0.5), "peak_torque_q1") == ""
    assert find_limit(sides(0.5), "peak_torque_q2").startswith("joint 2")


@pytest.mark.parametrize("metric", ["max_tracking_error", "settling_time", "saturation_fraction", "peak_joint_speed"])
def test_errors_and_speeds_are_compared_at_a_limit(metric):
    assert find_limit(sides(0.9), metric) == ""


def test_a_repetition_that_failed_is_at_no_limit():
    assert find_limit(sides(np.inf), "peak_torque") == ""
    assert limiting_joint(sides(np.inf)) == ("", "")


def test_a_sweep_without_shares_by_joint_names_none():
    sample = measurements(AXES, {"saturation_fraction": lambda law: np.array([0.5])})
    assert describe_limit([(sample, np.array([0]))]) == "a joint is at its torque limit"
