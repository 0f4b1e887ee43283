"""Divergence of a run: the first row that no arm can have, by joint and time."""

from types import SimpleNamespace

import numpy as np
import pytest

from runner.simulation.recorder import DIVERGED_SPEED, find_divergence

MODEL = SimpleNamespace(joint_names=["q1", "q2"], joint_units=["rad", "m"])
TIMES = 0.1 * np.arange(5)


@pytest.mark.parametrize("speed", [0.0, 0.999 * DIVERGED_SPEED, -0.999 * DIVERGED_SPEED])
def test_speeds_below_the_limit_are_well(speed):
    assert find_divergence(np.zeros((5, 2)), np.full((5, 2), speed), TIMES, MODEL) is None


@pytest.mark.parametrize("wild", [np.nan, np.inf, -np.inf, DIVERGED_SPEED, -DIVERGED_SPEED])
@pytest.mark.parametrize(("joint", "unit"), [(0, "rad/s"), (1, "m/s")])
def test_the_first_wild_row_counts(wild, joint, unit):
    dq = np.zeros((5, 2))
    dq[2:, joint] = wild
    failure = find_divergence(np.zeros((5, 2)), dq, TIMES, MODEL)
    assert (failure.time, failure.joint) == (TIMES[2], MODEL.joint_names[joint])
    assert failure.reason.endswith(f"above {DIVERGED_SPEED:g} {unit}")


def test_a_position_that_is_no_number_counts_too():
    q = np.zeros((5, 2))
    q[3, 1] = np.nan
    assert find_divergence(q, np.zeros((5, 2)), TIMES, MODEL).time == TIMES[3]
