"""Minimum-jerk joint motion through configurations, from rest to rest."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat, ValidationInfo, field_validator

from runner.base.errors import ConfigError
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, Seconds
from runner.trajectories.joint_motion import Configuration, JointMotion, configuration_of, start_of
from runner.trajectories.splines import check_time_shares, find_repeated, minimum_jerk, passing_times

_SAMPLES = 256  # between two configurations


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
            raise ValueError("must have one configuration or more besides the start")
        return value

    @field_validator("time_shares")
    @classmethod
    def _check_time_shares(cls, value: list[float] | None, info: ValidationInfo) -> list[float] | None:
        return check_time_shares(value, info, "configurations")


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
    index = find_repeated(configurations)
    if index is not None:
        before = f"trajectory.configurations.{index - 1}" if index else "the start"
        raise ConfigError(
            f"trajectory.configurations.{index}: is the same as {before}; two in succession must differ. Take one out"
        )
    return minimum_jerk(configurations, passing_times(configurations, config.time_shares, config.duration), _SAMPLES)
