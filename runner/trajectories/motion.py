"""Motions in R^n, of the tip or of the joints: a path times a time scaling, such as the quintic blend."""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.trajectories.geometry import distance_to_segment
from runner.trajectories.trajectory import TrackedMotion


def quintic_blend(u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return s and its first two derivatives by u, each of shape (T,); u below 0 or above 1 counts as 0 or 1.

    .. math:: s(u) = 10 u^3 - 15 u^4 + 6 u^5

    is the only quintic with s(0) = 0, s(1) = 1 and zero first and second derivatives at both ends (thesis eq. 3.39).
    """
    u = np.clip(u, 0.0, 1.0)
    return (
        u * u * u * (10.0 + u * (-15.0 + 6.0 * u)),
        30.0 * u**2 * (1.0 - u) ** 2,
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    )


Easing = Literal["quintic", "none"]
"""Time scaling of a closed curve in a config."""
TimeScaling = Literal["quintic", "cosine", "none"]


class Path(Protocol):
    """Curve c(u) in R^n, for u from 0 to 1."""

    @property
    def start(self) -> FloatArray:
        """Point at u = 0, shape (n,)."""

    @property
    def end(self) -> FloatArray:
        """Point at u = 1, shape (n,)."""

    def derivatives(self, u: FloatArray) -> FloatArray:
        """Return the point and its first two derivatives by u, shape (T, 3, n)."""

    def distance(self, points: FloatArray) -> FloatArray:
        """Return the distance of each point to the curve, shapes (..., n) to (...)."""


@dataclass(frozen=True)
class Segment:
    """Straight segment in R^n; see Path."""

    start: FloatArray
    end: FloatArray

    def derivatives(self, u: FloatArray) -> FloatArray:
        """Return the point and its derivatives; see Path."""
        D = self.end - self.start
        found = np.zeros((len(u), 3, len(D)))
        found[:, 0], found[:, 1] = np.outer(u, D) + self.start, D
        return found

    def distance(self, points: FloatArray) -> FloatArray:
        """Return the distance of points in R^3 to the segment; see Path."""
        return distance_to_segment(points, self.start, self.end)


class ClosedCurve:
    """Curve that ends at its start, and on which u can exceed 1; see Path."""

    start: FloatArray

    @property
    def end(self) -> FloatArray:
        """The start."""
        return self.start


@dataclass(frozen=True)
class PathMotion(TrackedMotion):
    r"""Motion along a path c(u) with u as a function of time; see Trajectory for the attributes.

    .. math:: \dot x = c' \dot u, \quad \ddot x = c'' \dot u^2 + c' \ddot u

    The time scaling "quintic" goes once from u = 0 to 1, from rest to rest, with u = s(t / t_f) (thesis eq. 3.39). The
    other two are periodic: "cosine" goes to u = 1 and back, u = (1 - cos(2 pi t / T)) / 2, and "none" has the constant
    rate u = t / T, which an arm at rest cannot follow immediately.

    Attributes:
        path: The path.
        duration: t_f, or the period T, in s.
        scaling: The time scaling.
        samples: Number of equal time intervals, so short that the path of the tip bends only once in each of them.
    """

    path: Path
    duration: float
    scaling: TimeScaling
    samples: int = 512

    @property
    def start(self) -> FloatArray:
        """Start of the path."""
        return self.path.start

    @property
    def goal(self) -> FloatArray | None:
        """End of the path; None if the motion is periodic."""
        return self.path.end if self.scaling == "quintic" else None

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion."""
        u, u_dot, u_ddot = self._scale(times)
        c, u_dot, u_ddot = self.path.derivatives(u), u_dot[:, None], u_ddot[:, None]
        return np.stack([c[:, 0], c[:, 1] * u_dot, c[:, 2] * u_dot**2 + c[:, 1] * u_ddot], axis=1)

    def _scale(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return u and its first two derivatives by time, shapes (T,)."""
        if self.scaling == "cosine":
            rate = 2.0 * np.pi / self.duration
            sine, cosine = np.sin(rate * times), np.cos(rate * times)
            return 0.5 * (1.0 - cosine), 0.5 * rate * sine, 0.5 * rate**2 * cosine
        share, rate = times / self.duration, 1.0 / self.duration
        if self.scaling == "none":
            return share, np.full_like(share, rate), np.zeros_like(share)
        s, s_prime, s_second = quintic_blend(share)
        return s, s_prime * rate, s_second * rate**2

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the path."""
        return self.path.distance(points)


def quintic_motion(start: FloatArray, goal: FloatArray, duration: float) -> PathMotion:
    r"""Return the rest-to-rest quintic (thesis eq. 3.39 with its six end conditions), in R^n.

    The only solution of the conditions, with D = goal - start and u = t / t_f, is

    .. math:: x(t) = x_0 + D (10 u^3 - 15 u^4 + 6 u^5)

    The peak speed is 1.875 |D| / t_f, at half time. In a joint motion, this is valid for each joint with its own D.
    """
    return PathMotion(Segment(start, goal), duration, "quintic")
