"""Closed curves, traced once from rest to rest or periodically at a constant parameter rate."""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.trajectories.blend import quintic_blend
from runner.trajectories.trajectory import TrackedMotion

TimeScaling = Literal["quintic", "none"]


class ClosedCurve(Protocol):
    """A curve that ends where it starts."""

    @property
    def start(self) -> FloatArray:
        """Point at u = 0 and u = 1, shape (3,), in m."""
        ...

    def derivatives(self, u: FloatArray) -> FloatArray:
        """Return the point and its first two derivatives by u, shape (T, 3, 3), in m; u from 0 may exceed 1."""
        ...

    def distance(self, points: FloatArray) -> FloatArray:
        """Return the distance of each point to the curve, shapes (..., 3) to (...), in m."""
        ...


@dataclass(frozen=True)
class ClosedFigure(TrackedMotion):
    r"""Motion along a closed curve c(u) with u as a function of time; see Trajectory for the attributes.

    With easing "quintic", u = s(t / t_f) goes once from 0 to 1, from rest to rest (thesis eq. 3.39), and the motion
    is twice continuously differentiable. With "none", u = t / T: the motion is periodic and starts at nonzero speed,
    which an arm at rest cannot follow immediately. In both cases

    .. math:: \dot x = c' \dot u, \quad \ddot x = c'' \dot u^2 + c' \ddot u

    Attributes:
        curve: The curve.
        easing: Time scaling u(t).
    """

    curve: ClosedCurve
    duration: float
    easing: TimeScaling

    @property
    def start(self) -> FloatArray:
        """Start of the curve."""
        return self.curve.start

    @property
    def goal(self) -> FloatArray | None:
        """Start of the curve if the motion ends at rest; None if it is periodic."""
        return self.curve.start if self.easing == "quintic" else None

    @property
    def run_duration(self) -> float:
        """One period; or one second more than a motion to rest, so that the settling of the arm is visible."""
        return self.duration + 1.0 if self.easing == "quintic" else self.duration

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion."""
        share, rate = times / self.duration, 1.0 / self.duration
        blend = quintic_blend(share) if self.easing == "quintic" else (share, np.ones_like(share), np.zeros_like(share))
        u, u_dot, u_ddot = blend[0], (blend[1] * rate)[:, None], (blend[2] * rate**2)[:, None]
        c = self.curve.derivatives(u)
        return np.stack([c[:, 0], c[:, 1] * u_dot, c[:, 2] * u_dot**2 + c[:, 1] * u_ddot], axis=1)

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the curve."""
        return self.curve.distance(points)
