"""Set-points between commands."""

import numpy as np
import pytest

from runner.plants.servo import SetPoints


@pytest.fixture
def stand_still():
    """Make set-points of one joint, 4 ticks of 10 ms per command, at rest at zero."""

    def make(speed_limit: float, interpolate: bool) -> SetPoints:
        points = SetPoints(4, 0.01, np.array([speed_limit]), interpolate)
        points.reset(np.zeros(1))
        return points

    return make


def follow(points: SetPoints, *commands: float) -> list[float]:
    """Return the set-point of every tick under commands that hold for 4 ticks each."""
    positions = []
    for command in commands:
        for _ in range(4):
            points.advance(np.array([command]))
            positions.append(float(points.position[0]))
    return positions


def test_interpolated_set_points_reach_each_command_when_the_next_one_comes(stand_still):
    points = stand_still(np.inf, interpolate=True)
    assert follow(points, 1.0, 3.0) == pytest.approx([0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0], abs=1e-15)
    assert points.velocity[0] == pytest.approx(50.0)


def test_jumping_set_points_are_there_at_once_and_bear_no_velocity(stand_still):
    points = stand_still(np.inf, interpolate=False)
    assert follow(points, 1.0, 3.0) == [1.0] * 4 + [3.0] * 4
    assert points.velocity[0] == 0.0


@pytest.mark.parametrize("interpolate", [True, False])
def test_no_set_point_moves_faster_than_the_joint_may(stand_still, interpolate):
    positions = follow(stand_still(20.0, interpolate), 1.0, 1.0)
    assert np.diff([0.0, *positions]).max() <= 0.2 + 1e-15
    assert positions[-1] == pytest.approx(1.0)


def test_reset_forgets_a_command_half_way(stand_still):
    points = stand_still(np.inf, interpolate=True)
    points.advance(np.array([1.0]))
    points.reset(np.array([5.0]))
    assert follow(points, 5.0) == [5.0] * 4
