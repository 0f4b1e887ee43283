"""Quintic joint motion between two configurations, from rest to rest."""

from typing import Literal

from pydantic import PositiveFloat

from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, Seconds
from runner.trajectories.joint_motion import Configuration, JointMotion, configuration_of, start_of
from runner.trajectories.motion import quintic_motion


class JointQuinticConfig(StrictModel):
    """Config of a quintic between configurations.

    Attributes:
        kind: Name of the kind in the registry.
        start_configuration: Joint positions at t = 0, in rad; m for prismatic joints. One value for all joints, or a
            list with one for each joint; None is the home configuration.
        goal_configuration: Joint positions at t_f, in rad; m for prismatic joints. One value for all joints, or a list
            with one for each joint.
        duration: t_f, in s.
    """

    kind: Literal["joint_quintic"]
    start_configuration: JointPosition[Configuration | None]
    goal_configuration: JointPosition[Configuration]
    duration: Seconds[PositiveFloat]


CONFIG = JointQuinticConfig


def joint_motion(config: JointQuinticConfig, robot: Robot) -> JointMotion:
    """Build the motion that a config describes.

    Raises:
        ConfigError: if the length of a configuration differs from the number of joints.
    """
    goal = configuration_of("trajectory.goal_configuration", config.goal_configuration, robot)
    return quintic_motion(start_of(config.start_configuration, robot), goal, config.duration)
