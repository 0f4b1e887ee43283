"""Motions in R^n through given points at given times: minimum-jerk, cubic and Hermite splines."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Literal

import numpy as np
from pydantic import ValidationInfo

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import splines
from runner.trajectories.geometry import distance_to_curve
from runner.trajectories.trajectory import TrackedMotion

Interpolation = Literal["spline", "hermite"]

_CLOSEST = 1e-9  # smallest distance of two points, as a fraction of the duration or of the total length
_LEAST, _PER_ROW, _MOST = 512, 64, 4096  # samples


@dataclass(frozen=True)
class Spline(TrackedMotion):
    """Motion through points, from rest to rest; see Trajectory for the attributes.

    Attributes:
        start: First point, shape (n,).
        goal: Last point, shape (n,).
        duration: Time t_f of the last point, in s.
        orders: Position and its first two derivatives, as functions of time.
        places: Times between which the distance to a point has one minimum.
        samples: Number of equal time intervals, so short that the path of the tip bends only once in each of them.
    """

    start: FloatArray
    goal: FloatArray
    duration: float
    orders: Sequence[Callable[[FloatArray], FloatArray]]
    places: FloatArray
    samples: int

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion and two derivatives, shape (T, 3, n); after t_f it rests at the last point."""
        within = np.clip(times, 0.0, self.duration)
        motion: FloatArray = np.stack([order(within) for order in self.orders], axis=1)
        motion[times > self.duration, 1:] = 0.0
        return motion

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the curve through the points."""
        return distance_to_curve(points, self.sample, self.places)


def minimum_jerk(points: FloatArray, times: FloatArray, samples: int = 64) -> Spline:
    """Return the minimum-jerk motion from rest to rest through points at times, shapes (N, n) and (N,).

    Among the motions that pass the points at their times, from rest to rest, the one with the smallest integral of
    squared jerk is a spline of fifth order with four continuous derivatives (Flash and Hogan 1985, who describe human
    hand motions with it). Through two points it is the quintic.

    Args:
        points: The points.
        times: Time of each point, ascending from 0, in s.
        samples: Number of samples between two points.
    """
    rest = [(order, np.zeros(points.shape[1])) for order in (1, 2)]
    spline = splines.make_interp_spline(times, points, k=5, bc_type=(rest, rest))
    between = [np.linspace(a, b, samples, endpoint=False) for a, b in pairwise(times)]
    return Spline(
        np.array(points[0]),
        np.array(points[-1]),
        float(times[-1]),
        [partial(spline, nu=order) for order in range(3)],
        np.concatenate([*between, times[-1:]]),
        samples * (len(times) - 1),
    )


def interpolate(times: FloatArray, rows: FloatArray, kind: Interpolation) -> Spline:
    """Return a motion that passes each row at its time.

    `spline` is the cubic spline through the positions with zero velocity at both ends. Its velocities and accelerations
    are continuous. `hermite` also uses the given velocities, and accelerations if given. It is cubic between rows, with
    continuous velocities, or of fifth order, with continuous accelerations.

    Args:
        times: Time of each row, shape (N,), in s.
        rows: Positions and given derivatives, shape (N, orders, n).
        kind: Kind of interpolation.
    """
    if kind == "spline":
        curve = splines.CubicSpline(times, rows[:, 0], bc_type="clamped")
    else:
        curve = splines.BPoly.from_derivatives(times, rows)
    samples = min(max(_PER_ROW * (len(times) - 1), _LEAST), _MOST)
    start, goal = curve(times[[0, -1]])
    even = np.linspace(0.0, float(times[-1]), samples + 1)
    orders = (curve, curve.derivative(1), curve.derivative(2))
    return Spline(start, goal, float(times[-1]), orders, np.union1d(even, times), samples)


def check_time_shares(value: list[float] | None, info: ValidationInfo, places: str) -> list[float] | None:
    """Return time shares after checking them against the field of way-points named `places`, which precedes them.

    Raises:
        ValueError: if their number differs, if they do not ascend, or if the last one is not 1.
    """
    if value is None or places not in info.data:
        return value
    count = len(info.data[places])
    if len(value) != count or value[-1] != 1.0 or any(b - a < _CLOSEST for a, b in pairwise(value)):
        raise ValueError(f"must be {count} ascending numbers, one for each of the {places}, the last of them 1")
    return value


def find_repeated(points: FloatArray) -> int | None:
    """Return the index of the way-point that equals the point before it, counted without the start; None if none does.

    Args:
        points: The start and the way-points, shape (N, n).
    """
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    repeated = (lengths < _CLOSEST * lengths.sum()).any() or not lengths.any()
    return int(np.argmin(lengths)) if repeated else None


def passing_times(points: FloatArray, shares: list[float] | None, duration: float) -> FloatArray:
    """Return the times of N points, in s, from the distances between them or the given time shares."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    ends = np.cumsum(lengths) / lengths.sum() if shares is None else np.array(shares)
    times: FloatArray = duration * np.concatenate([[0.0], ends[:-1], [1.0]])
    return times
