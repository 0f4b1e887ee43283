"""Springs of flexible links that bend too far: the time of the failure, in each run of the same plant."""

import numpy as np
import pytest

from runner.base.errors import SimulationError
from runner.papers.studies.thesis_beyond.cantilever import clamped_arm
from runner.plants.rk4_flexible_links import FlexibleLinks
from runner.robots.vibration import Beam, cut

TICK = 1e-3  # s, of two steps
TORQUE = 3e3 * np.ones(1)  # N m


def plant():
    chain = cut(clamped_arm(1.0, 1.0), "tip", {"beam": Beam(200.0, 1e-9)}, 1)
    return FlexibleLinks(chain, np.ones(1), np.zeros((2, 2)), TICK / 2, 2, ["tip"])


def ticks_until_it_fails(arm, before=0):
    """Return the number of ticks and the time of the failure, from the start of a run."""
    arm.reset(np.zeros(1), np.zeros(1))
    for _ in range(before):
        arm.advance(np.zeros(1))
    for tick in range(1, 1000):
        try:
            arm.advance(TORQUE)
        except SimulationError as error:
            return before + tick, error.time
    raise AssertionError("it never bends too far")


def test_the_failure_tells_the_end_of_its_tick():
    ticks, time = ticks_until_it_fails(plant())
    assert ticks > 1
    assert time == pytest.approx(ticks * TICK, abs=1e-12)


def test_the_time_begins_anew_in_each_run():
    arm = plant()
    first = ticks_until_it_fails(arm)
    assert ticks_until_it_fails(arm) == first
    ticks, time = ticks_until_it_fails(arm, before=7)
    assert (ticks, time) == (first[0] + 7, pytest.approx(first[1] + 7 * TICK, abs=1e-12))
