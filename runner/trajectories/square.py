"""Square with a rest at each corner."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.geometry import Direction, InPlane, Point, distance_to_segment, plane_axes
from runner.trajectories.motion import quintic_blend
from runner.trajectories.trajectory import TrackedMotion, Trajectory


class SquareConfig(StrictModel):
    """Config of a square whose first corner is the start.

    Attributes:
        kind: Name of the kind in the registry.
        start: Tip position at t = 0, in m; None is the tip at the home configuration.
        half_edge: Half the length of an edge, in m.
        normal: Axis of the counter-clockwise motion; the length of the vector has no effect.
        edge_direction: Direction of the first edge, perpendicular to the normal, of any length.
        duration: Time t_f of all four edges, in s.
    """

    kind: Literal["square"]
    start: Metres[Point | None]
    half_edge: Metres[PositiveFloat]
    normal: Direction
    edge_direction: InPlane
    duration: Seconds[PositiveFloat]


@dataclass(frozen=True)
class Square(TrackedMotion):
    """One round of a square, with a quintic from rest to rest along each edge; see Trajectory for the attributes.

    The motion passes the corners exactly and is twice continuously differentiable. The peak speed is 1.875 times the
    edge divided by t_f / 4.

    Attributes:
        corners: The corners in order, with the first one repeated at the end, shape (5, 3), in m.
    """

    corners: FloatArray
    duration: float

    @property
    def start(self) -> FloatArray:
        """The first corner."""
        return np.array(self.corners[0])

    @property
    def goal(self) -> FloatArray:
        """The first corner again."""
        return self.start

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests at the first corner."""
        rate = 4.0 / self.duration
        edge = np.clip(np.floor(rate * times), 0, 3).astype(int)
        D = self.corners[edge + 1] - self.corners[edge]
        s, s_prime, s_second = (value[:, None] for value in quintic_blend(rate * times - edge))
        return np.stack([self.corners[edge] + s * D, rate * s_prime * D, rate**2 * s_second * D], axis=1)

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the nearest edge."""
        edges = zip(self.corners[:-1], self.corners[1:], strict=True)
        distance: FloatArray = np.min([distance_to_segment(points, a, b) for a, b in edges], axis=0)
        return distance


CONFIG = SquareConfig


def build(config: SquareConfig, start: FloatArray) -> Trajectory:
    """Build the square that a config describes; `start` is the tip at t = 0."""
    first, second = (2.0 * config.half_edge * axis for axis in plane_axes(config.normal, config.edge_direction))
    corners = np.array([start, start + first, start + first + second, start + second, start])
    return Square(corners, config.duration)
