"""Periodic straight line from A to B and back, by a cosine of time."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.nearest import distance_to_segment
from runner.trajectories.trajectory import TrackedMotion, Trajectory
from runner.trajectories.vectors import Point


class LineConfig(StrictModel):
    """Config of a line.

    Attributes:
        kind: Name of the kind in the registry.
        start: A, the tip position at t = 0, in m; None is the tip at the home configuration.
        goal: B, the tip position half a period later, in m.
        duration: Period T, from A to B and back, in s.
    """

    kind: Literal["line"]
    start: Metres[Point | None]
    goal: Metres[Point]
    duration: Seconds[PositiveFloat]


@dataclass(frozen=True)
class Line(TrackedMotion):
    r"""Periodic line of the xArm7 report between its points P_A and P_B; see Trajectory for the attributes.

    The report ("Trajectory planning") slows the tip down towards both ends by "a sinusoidal function" of its
    coordinate P_ey and prints no formula. It is interpreted as a harmonic motion from rest in A, with D = B - A:

    .. math:: x(t) = A + \tfrac{1}{2} D (1 - \cos(2 \pi t / T))

    The position is then a cosine of the phase, and the speed is the sine of the same phase. The peak speed is
    pi |D| / T, half way. The peak acceleration is 2 pi^2 |D| / T^2, at both ends. The acceleration has a step at t = 0,
    because the arm is at rest before.

    Attributes:
        end: B, shape (3,), in m.
    """

    start: FloatArray
    end: FloatArray
    duration: float
    goal: None = None

    @property
    def run_duration(self) -> float:
        """One period."""
        return self.duration

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion, which continues after one period."""
        rate = 2.0 * np.pi / self.duration
        D = self.end - self.start
        motion = np.empty((len(times), 3, 3))
        motion[:, 0] = self.start + np.outer(0.5 * (1.0 - np.cos(rate * times)), D)
        motion[:, 1] = np.outer(0.5 * rate * np.sin(rate * times), D)
        motion[:, 2] = np.outer(0.5 * rate**2 * np.cos(rate * times), D)
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the segment from A to B."""
        return distance_to_segment(points, self.start, self.end)


CONFIG = LineConfig


def build(config: LineConfig, start: FloatArray) -> Trajectory:
    """Build the line that a config describes; `start` is the tip at t = 0.

    Raises:
        ConfigError: if the length of the line is zero.
    """
    end = np.array(config.goal)
    if np.array_equal(start, end):
        raise ConfigError(f"trajectory.goal: {config.goal} m is the start, and a line leads elsewhere. Choose another")
    return Line(start, end, config.duration)
