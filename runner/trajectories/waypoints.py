"""Minimum-jerk motion through way-points, from rest to rest."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Seconds
from runner.trajectories.geometry import Point
from runner.trajectories.splines import check_time_shares, find_repeated, minimum_jerk, passing_times
from runner.trajectories.trajectory import Trajectory


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
            raise ValueError("must have one way-point or more besides the start")
        return value

    @field_validator("time_shares")
    @classmethod
    def _check_time_shares(cls, value: list[float] | None, info: ValidationInfo) -> list[float] | None:
        return check_time_shares(value, info, "points")


CONFIG = WaypointsConfig


def build(config: WaypointsConfig, start: FloatArray) -> Trajectory:
    """Build the motion that a config describes; `start` is the tip at t = 0.

    Raises:
        ConfigError: if two consecutive way-points coincide.
    """
    origin = start if config.origin is None else np.array(config.origin)
    points = np.vstack([start, origin + config.scale * np.array(config.points)])
    index = find_repeated(points)
    if index is not None:
        before = f"trajectory.points.{index - 1}" if index else "the start"
        raise ConfigError(
            f"trajectory.points.{index}: lies where {before} does, at {points[index].tolist()} m; two in "
            "succession must differ. Take one out"
        )
    return minimum_jerk(points, passing_times(points, config.time_shares, config.duration))
