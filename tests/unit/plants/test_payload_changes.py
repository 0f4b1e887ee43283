"""Payload changes: the plant that moves at each tick, and a state without a jump."""

import numpy as np
import pytest

from runner.plants import Plant
from runner.plants.wrappers import PayloadChanges


class Even(Plant):
    """A joint that each tick accelerates by its torque over its payload."""

    def __init__(self, mass):
        self.q, self.dq, self.mass, self.closed, self.gravity = np.zeros(1), np.zeros(1), mass, False, None

    def reset(self, q, dq):
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity):
        self.gravity = gravity

    def advance(self, tau):
        self.dq += tau / self.mass
        self.q += self.dq

    def close(self):
        self.closed = True


@pytest.fixture
def plants():
    return [Even(1.0), Even(2.0), Even(4.0)]


def test_each_payload_moves_from_its_tick_on_and_nothing_jumps(plants):
    arm, speeds = PayloadChanges(plants, [2, 3]), []
    arm.reset(np.array([0.5]), np.array([1.0]))
    for _ in range(4):
        arm.advance(np.ones(1))
        speeds.append(float(arm.dq[0]))
    assert speeds == [2.0, 3.0, 3.5, 3.75]
    assert arm.q[0] == 0.5 + sum(speeds)
    assert arm.plant is plants[2]


def test_a_reset_starts_with_the_first_payload(plants):
    arm = PayloadChanges(plants, [0, 1])
    for _ in range(2):
        arm.reset(np.zeros(1), np.zeros(1))
        assert arm.plant is plants[0]
        arm.advance(np.ones(1))
        assert arm.plant is plants[1]


def test_gravity_and_closing_reach_every_plant(plants):
    arm = PayloadChanges(plants, [1, 2])
    arm.set_gravity("down")
    arm.close()
    assert [(plant.gravity, plant.closed) for plant in plants] == [("down", True)] * 3
