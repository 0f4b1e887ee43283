"""Statements of a sweep on its plant's step and on the way to the goal, against stored runs."""

from dataclasses import replace

import numpy as np
import pytest

from runner.robots.model import RobotModel
from runner.sweeps.differing import DISTANCE, Resolver
from runner.sweeps.job import run


@pytest.fixture
def stored(tmp_path):
    short = ("robot=macro", "trajectory=quintic", "trajectory.goal=[0.8,0.6,0.7]", "duration=0.05")
    return run(*short, f"outputs={tmp_path}")


def test_the_step_of_the_plant_and_the_way_to_the_goal_are_told(stored):
    resolved = Resolver().resolve(stored)
    assert stored.config["plant"]["step"] is None
    assert resolved["plant"]["step"] == stored.provenance["plant_step"]
    home = RobotModel(stored.urdf, "tip").tip_position(np.zeros(3))
    assert float(resolved[DISTANCE]) == pytest.approx(np.linalg.norm(home - [0.8, 0.6, 0.7]), rel=1e-3)


def test_a_written_start_counts_and_a_path_without_goal_has_no_distance(stored):
    resolver = Resolver()
    for trajectory, distance in (({"start": [0.0, 0.0, 0.0], "goal": [0, 3, 4]}, 5.0), ({"start": None}, None)):
        other = replace(stored, config={**stored.config, "trajectory": trajectory})
        assert resolver.resolve(other).get(DISTANCE) == distance


def test_distances_are_equal_if_their_numbers_are(stored):
    distance = Resolver().resolve(stored)[DISTANCE]
    assert distance == Resolver().resolve(stored)[DISTANCE]
    assert distance == replace(distance, urdf=f"{distance.urdf}\n")
    assert distance != replace(distance, goal=(0.8, 0.6, 0.8))
