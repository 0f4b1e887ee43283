"""Circle about an arbitrary axis."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import PositiveFloat, PositiveInt

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.geometry import Direction, InPlane, Point, component, plane_axes
from runner.trajectories.motion import ClosedCurve, Easing, PathMotion
from runner.trajectories.trajectory import Trajectory


class CircleConfig(StrictModel):
    """Config of a circle through the start; the centre is start + radius * centre_direction for a unit direction.

    Attributes:
        kind: Name of the kind in the registry.
        start: Tip position at t = 0, in m; None is the tip at the home configuration.
        radius: Radius, in m.
        normal: Axis of the counter-clockwise rotation; the length of the vector has no effect.
        centre_direction: Direction from the start to the centre, perpendicular to the normal, of any length.
        turns: Number of turns.
        easing: "quintic" for one motion from rest to rest, "none" for a periodic motion at constant speed.
        duration: Time of all turns, in s.
    """

    kind: Literal["circle"]
    start: Metres[Point | None]
    radius: Metres[PositiveFloat]
    normal: Direction
    centre_direction: InPlane
    turns: PositiveInt
    easing: Easing
    duration: Seconds[PositiveFloat]


@dataclass(frozen=True)
class Circle(ClosedCurve):
    r"""A circle, with phi = 2 pi turns u, and unit vectors e to the centre and f along the initial motion.

    .. math:: c(u) = x_0 + r (1 - \cos \varphi) e + r \sin \varphi f

    Attributes:
        start: x_0, shape (3,), in m.
        radius: r, in m.
        to_centre: e, shape (3,).
        along: f, shape (3,), perpendicular to e.
        turns: Number of turns for u from 0 to 1.
    """

    start: FloatArray
    radius: float
    to_centre: FloatArray
    along: FloatArray
    turns: int

    def derivatives(self, u: FloatArray) -> FloatArray:
        """Return the point and its first two derivatives by u, shape (T, 3, 3), in m."""
        rate = 2.0 * np.pi * self.turns
        cosine, sine = np.cos(rate * u), np.sin(rate * u)
        e, f = self.radius * self.to_centre, self.radius * self.along
        return np.stack(
            [
                self.start + np.outer(1.0 - cosine, e) + np.outer(sine, f),
                rate * (np.outer(sine, e) + np.outer(cosine, f)),
                rate**2 * (np.outer(cosine, e) - np.outer(sine, f)),
            ],
            axis=1,
        )

    def distance(self, points: FloatArray) -> FloatArray:
        """Return the distance of each point to the circle, shapes (..., 3) to (...), in m."""
        from_centre = points - self.start - self.radius * self.to_centre
        height = component(from_centre, np.cross(self.to_centre, self.along))
        beyond = np.hypot(component(from_centre, self.to_centre), component(from_centre, self.along)) - self.radius
        distance: FloatArray = np.hypot(height, beyond)
        return distance


CONFIG = CircleConfig


def build(config: CircleConfig, start: FloatArray) -> Trajectory:
    """Build the circle that a config describes; `start` is the tip at t = 0."""
    e, g = plane_axes(config.normal, config.centre_direction)
    # In a counter-clockwise rotation about the normal, the tip leaves the start towards -g.
    return PathMotion(Circle(start, config.radius, e, -g, config.turns), config.duration, config.easing)
