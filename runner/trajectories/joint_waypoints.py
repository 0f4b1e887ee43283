"""Minimum-jerk joint motion through configurations, from rest to rest."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import splines
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, Seconds
from runner.trajectories.joint_motion import Configuration, JointMotion, configuration_of, start_of
from runner.trajectories.waypoints import check_time_shares, least_jerk_spline, passing_times

_SAMPLES = 256  # between two configurations
_CLOSEST = 1e-9  # fraction of the total joint motion below which two configurations count as equal


class JointWaypointsConfig(StrictModel):
    """Config of a motion from the start through configurations.

    Attributes:
        kind: Name of the kind in the registry.
        start_configuration: Joint positions at t = 0, in rad; m for prismatic joints. One value for all joints, or a
            list with one for each joint; None is the home configuration.
        configurations: Configurations after the start, in rad; m for prismatic joints. Each is one value for all
            joints, or a list with one for each joint.
        time_shares: Time of each configuration as a fraction of the duration, ascending to 1. None makes the time
            between two configurations proportional to the norm of their difference.
        duration: t_f, in s.
    """

    kind: Literal["joint_waypoints"]
    start_configuration: JointPosition[Configuration | None]
    configurations: JointPosition[list[Configuration]]
    time_shares: list[PositiveFloat] | None
    duration: Seconds[PositiveFloat]

    @field_validator("configurations")
    @classmethod
    def _check_configurations(cls, value: list[Configuration]) -> list[Configuration]:
        if not value:
            raise ValueError("must have one configuration or more beside the start")
        return value

    @field_validator("time_shares")
    @classmethod
    def _check_time_shares(cls, value: list[float] | None, info: ValidationInfo) -> list[float] | None:
        return check_time_shares(value, info, "configurations")


@dataclass(frozen=True)
class JointWaypoints:
    """Minimum-jerk motion of the joints through configurations at given times; see Waypoints and JointMotion.

    Attributes:
        spline: Joint positions over time, in rad and s.
        duration: t_f, in s.
        samples: Number of equal time intervals; see JointMotion.
    """

    spline: "splines.BSpline"
    duration: float
    samples: int

    def sample_joints(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests in the last configuration."""
        within = np.clip(times, 0.0, self.duration)
        return np.stack([self.spline(within, order) for order in range(3)], axis=1)


CONFIG = JointWaypointsConfig


def joint_motion(config: JointWaypointsConfig, robot: Robot) -> JointMotion:
    """Build the motion that a config describes.

    Raises:
        ConfigError: if the length of a configuration differs from the number of joints, or if two consecutive
            configurations are equal.
    """
    given = [
        configuration_of(f"trajectory.configurations.{n}", value, robot)
        for n, value in enumerate(config.configurations)
    ]
    configurations = np.array([start_of(config.start_configuration, robot), *given])
    lengths = np.linalg.norm(np.diff(configurations, axis=0), axis=1)
    if (lengths < _CLOSEST * lengths.sum()).any() or not lengths.any():
        index = int(np.argmin(lengths))
        before = f"trajectory.configurations.{index - 1}" if index else "the start"
        raise ConfigError(
            f"trajectory.configurations.{index}: is the same as {before}; two in succession must differ. Take one out"
        )
    times = passing_times(lengths, config.time_shares, config.duration)
    return JointWaypoints(least_jerk_spline(configurations, times), config.duration, _SAMPLES * len(given))
