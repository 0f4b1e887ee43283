"""Minimum-jerk motion through way-points, from rest to rest."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from pydantic import PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import splines
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.nearest import distance_to_curve
from runner.trajectories.trajectory import TrackedMotion, Trajectory
from runner.trajectories.vectors import Point

_SAMPLES = 64  # between two way-points, from which the nearest point is refined
_CLOSEST = 1e-9  # smallest distance of two way-points, as a fraction of the duration or of the total length


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


class WaypointsConfig(StrictModel):
    """Config of a motion from the start through way-points.

    Attributes:
        kind: Name of the kind in the registry.
        start: Tip position at t = 0, in m; None is the tip at the home configuration.
        origin: Origin of the way-points in the base frame, in m; None is the start.
        scale: Length of one unit of the way-points, in m; 1 for points in m.
        points: Way-points after the start, in units of scale, along the axes of the base frame.
        time_shares: Time of each way-point as a fraction of the duration, ascending to 1. None makes the time between
            two way-points proportional to their distance.
        duration: t_f, in s.
    """

    kind: Literal["waypoints"]
    start: Metres[Point | None]
    origin: Metres[Point | None]
    scale: Metres[PositiveFloat]
    points: list[Point]
    time_shares: list[PositiveFloat] | None
    duration: Seconds[PositiveFloat]

    @field_validator("points")
    @classmethod
    def _check_points(cls, value: list[list[float]]) -> list[list[float]]:
        if not value:
            raise ValueError("must have one way-point or more beside the start")
        return value

    @field_validator("time_shares")
    @classmethod
    def _check_time_shares(cls, value: list[float] | None, info: ValidationInfo) -> list[float] | None:
        return check_time_shares(value, info, "points")


@dataclass(frozen=True)
class Waypoints(TrackedMotion):
    """Minimum-jerk motion through points at given times; see Trajectory for the attributes.

    Among the motions that pass the way-points at their times, from rest to rest, the one with the smallest integral of
    squared jerk is a spline of fifth order with four continuous derivatives (Flash and Hogan 1985, who describe human
    hand motions with it). With one way-point after the start it is the quintic.

    Attributes:
        points: The start and the way-points, shape (N, 3), in m.
        times: Time of each point, ascending from 0, shape (N,), in s.
        spline: Tip position over time, in m and s.
    """

    points: FloatArray
    times: FloatArray
    spline: "splines.BSpline"

    @property
    def start(self) -> FloatArray:
        """The first point."""
        return np.array(self.points[0])

    @property
    def goal(self) -> FloatArray:
        """The last way-point."""
        return np.array(self.points[-1])

    @property
    def duration(self) -> float:
        """Time t_f of the last way-point, in s."""
        return float(self.times[-1])

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests at the last way-point."""
        within = np.clip(times, 0.0, self.duration)
        return np.stack([self.spline(within, order) for order in range(3)], axis=1)

    def distance_to_path(self, points: FloatArray) -> FloatArray:
        """Return the distance to the curve through the way-points."""
        between = [np.linspace(a, b, _SAMPLES, endpoint=False) for a, b in pairwise(self.times)]
        return distance_to_curve(points, self.sample, np.concatenate([*between, self.times[-1:]]))


def minimum_jerk(points: FloatArray, times: FloatArray) -> Waypoints:
    """Return the minimum-jerk motion through points at times; see Waypoints for both."""
    return Waypoints(points, times, least_jerk_spline(points, times))


def passing_times(lengths: FloatArray, shares: list[float] | None, duration: float) -> FloatArray:
    """Return the times of N + 1 points, in s, from the N distances between them or the given time shares."""
    ends = np.cumsum(lengths) / lengths.sum() if shares is None else np.array(shares)
    times: FloatArray = duration * np.concatenate([[0.0], ends[:-1], [1.0]])
    return times


def least_jerk_spline(points: FloatArray, times: FloatArray) -> "splines.BSpline":
    """Return the minimum-jerk spline from rest to rest through points at times, shapes (N, k) and (N,)."""
    rest = [(order, np.zeros(points.shape[1])) for order in (1, 2)]
    return splines.make_interp_spline(times, points, k=5, bc_type=(rest, rest))


CONFIG = WaypointsConfig


def build(config: WaypointsConfig, start: FloatArray) -> Trajectory:
    """Build the motion that a config describes; `start` is the tip at t = 0.

    Raises:
        ConfigError: if two consecutive way-points coincide.
    """
    origin = start if config.origin is None else np.array(config.origin)
    points = np.vstack([start, origin + config.scale * np.array(config.points)])
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if (lengths < _CLOSEST * lengths.sum()).any() or not lengths.any():
        index = int(np.argmin(lengths))
        before = f"trajectory.points.{index - 1}" if index else "the start"
        raise ConfigError(
            f"trajectory.points.{index}: lies where {before} does, at {points[index].tolist()} m; two in "
            "succession must differ. Take one out"
        )
    return minimum_jerk(points, passing_times(lengths, config.time_shares, config.duration))
