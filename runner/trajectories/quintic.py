"""Quintic straight-line motion from rest to rest."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.blend import quintic_motion
from runner.trajectories.nearest import distance_to_segment
from runner.trajectories.trajectory import TrackedMotion, Trajectory
from runner.trajectories.vectors import Point


class QuinticConfig(StrictModel):
    """Config of a quintic.

    Attributes:
        kind: Name of the kind in the registry.
        start: Tip position at t = 0, in m; None is the tip at the home configuration.
        goal: Tip position at t_f, in m.
        duration: t_f, in s.
    """

    kind: Literal["quintic"]
    start: Metres[Point | None]
    goal: Metres[Point]
    duration: Seconds[PositiveFloat]


@dataclass(frozen=True)
class Quintic(TrackedMotion):
    r"""Rest-to-rest quintic (thesis eq. 3.39 with its six end conditions); see Trajectory for the attributes.

    The only solution of the conditions, with D = goal - start and u = t / t_f, is

    .. math:: x(t) = x_0 + D (10 u^3 - 15 u^4 + 6 u^5)

    The peak speed is 1.875 |D| / t_f, at half time.
    """

    start: FloatArray
    goal: FloatArray
    duration: float

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests at the goal."""
        return quintic_motion(self.start, self.goal, self.duration, times)

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the straight segment from start to goal."""
        return distance_to_segment(points, self.start, self.goal)


CONFIG = QuinticConfig


def build(config: QuinticConfig, start: FloatArray) -> Trajectory:
    """Build the quintic that a config describes; `start` is the tip at t = 0."""
    return Quintic(start, np.array(config.goal), config.duration)
