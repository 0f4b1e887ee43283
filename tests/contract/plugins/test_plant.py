"""Guarded plants: states that are none, and the failure's place."""

import re
from dataclasses import replace

import numpy as np
import pytest

from runner.plants import PLANTS
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders


class Plant:
    """A plant of the user that rests and breaks in its third tick."""

    def __init__(self):
        self.q, self.dq, self.ticks = np.array([0.1, 0.2, 0.3]), np.zeros(3), 0

    def reset(self, q, dq):
        self.ticks = 0

    def advance(self, tau):
        self.ticks += 1
        if self.ticks == 3:
            raise RuntimeError("a gear broke")

    def close(self):
        pass


def test_a_plant_that_raises_is_a_failure_that_names_the_place(checked_config, closed_loop):
    loop = replace(closed_loop("robot=macro", "duration=0.2"), plant=PLANTS.guard(Plant()))
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert re.fullmatch(r"RuntimeError: a gear broke \(test_plant.py, line \d+, in advance\)", trace.failure.reason)
    assert trace.failure.time == pytest.approx(0.02)
    assert trace.q.tolist() == [[0.1, 0.2, 0.3]] * 3


def test_a_guarded_plant_has_the_defaults_of_what_the_plant_lacks():
    plant = PLANTS.guard(Plant())
    assert plant.q.tolist() == [0.1, 0.2, 0.3]
    assert plant.add_wall(np.zeros(3), np.zeros(3), 1.0, 0.0) is False
    assert plant.contact_wrench() is None
    assert plant.tool_reaction() is None
    assert plant.friction.tolist() == [0.0, 0.0, 0.0]


def test_a_plant_without_a_load_gets_the_torques_of_the_world_with_those_of_the_motors():
    plant, given = Plant(), []
    plant.advance = given.append
    PLANTS.guard(plant).push(np.array([1.0, 2.0, 3.0]), np.full(3, 0.5))
    assert [tau.tolist() for tau in given] == [[1.5, 2.5, 3.5]]


def write(*handed):
    handed[-1][:] = 1.0


@pytest.mark.parametrize("method", ["reset", "advance"])
def test_a_plant_that_changes_what_it_is_handed_is_a_failure(checked_config, closed_loop, method):
    plant = Plant()
    setattr(plant, method, write)
    loop = replace(closed_loop("robot=macro", "duration=0.2"), plant=PLANTS.guard(plant))
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert trace.failure.time == 0.0
    assert re.search(r"read-only \(test_plant.py, line \d+, in write\)", trace.failure.reason)


def test_a_plant_with_a_state_of_another_shape_is_a_failure(checked_config, closed_loop):
    plant = Plant()
    plant.dq = np.zeros(2)
    loop = replace(closed_loop("robot=macro", "duration=0.2"), plant=PLANTS.guard(plant))
    trace = simulate(loop, make_encoders(loop, checked_config("robot=macro", "duration=0.2").noise, 0, 0))
    assert trace.failure.reason == "Plant.dq has the shape (2,); it must be (3,)"
