"""Goal: a desired tip at rest and the distance to the segment that leads to it."""

import numpy as np
import pytest

from runner.trajectories import TRAJECTORIES
from runner.trajectories.goal import Goal, GoalConfig, build

START, GOAL = np.array([0.0, 1.0, 1.0]), np.array([0.1679, -0.7571, 0.4255])


def test_the_desired_tip_stands_at_the_goal_from_the_first_tick_on():
    motion = Goal(START, GOAL).sample(np.array([0.0, 0.01, 1.0, 100.0]))
    assert motion.shape == (4, 3, 3)
    np.testing.assert_array_equal(motion[:, 0], np.tile(GOAL, (4, 1)))
    np.testing.assert_array_equal(motion[:, 1:], 0.0)


def test_a_goal_is_not_tracked_and_runs_for_4_s():
    goal = Goal(START, GOAL)
    assert (goal.duration, goal.run_duration, goal.tracked) == (0.0, 4.0, False)


def test_the_path_is_the_segment_from_start_to_goal():
    goal = Goal(np.zeros(3), np.array([2.0, 0.0, 0.0]))
    points = np.array([[1.0, 0.0, 0.0], [1.0, 3.0, 4.0], [-3.0, 4.0, 0.0], [5.0, 0.0, 4.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(goal.distance_to_path(points), [0.0, 5.0, 5.0, 5.0, 0.0], atol=1e-15)


def test_the_path_may_be_a_point():
    goal = Goal(START, START)
    np.testing.assert_allclose(goal.distance_to_path(START + np.array([[0.0, 3.0, 4.0]])), [5.0])


def test_build_takes_the_start_it_is_given():
    config = GoalConfig(kind="goal", start=None, goal=GOAL.tolist())
    for goal in (build(config, START), TRAJECTORIES.build(config, START)):
        np.testing.assert_array_equal(goal.start, START)
        np.testing.assert_array_equal(goal.goal, GOAL)


@pytest.mark.parametrize("goal", [[1.0, 2.0], [1.0, 2.0, 3.0, 4.0]])
def test_a_goal_has_three_coordinates(goal):
    with pytest.raises(ValueError, match="goal"):
        GoalConfig(kind="goal", start=None, goal=goal)
