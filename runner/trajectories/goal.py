"""Goal position: constant desired tip position from the first tick."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres
from runner.trajectories.geometry import Point, distance_to_segment
from runner.trajectories.trajectory import OfTip, Trajectory


class GoalConfig(StrictModel):
    """Config of a goal.

    Attributes:
        kind: Name of the kind in the registry.
        start: Tip position at t = 0, in m; None is the tip at the home configuration.
        goal: Goal position of the tip, in m.
    """

    kind: Literal["goal"]
    start: Metres[Point | None]
    goal: Metres[Point]


@dataclass(frozen=True)
class Goal(OfTip):
    """Constant goal position (thesis section 3.3.1); see Trajectory for the attributes."""

    start: FloatArray
    goal: FloatArray
    duration: float = 0.0
    run_duration: float = 4.0
    tracked: bool = False

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the goal with zero velocity and acceleration for each time."""
        motion = np.zeros((len(times), 3, 3))
        motion[:, 0] = self.goal
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the straight segment from start to goal."""
        return distance_to_segment(points, self.start, self.goal)


CONFIG = GoalConfig


def build(config: GoalConfig, start: FloatArray) -> Trajectory:
    """Build the goal that a config describes; `start` is the tip at t = 0."""
    return Goal(start, np.array(config.goal))
