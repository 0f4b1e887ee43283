"""Quintic joint motion between two configurations, from rest to rest."""

from dataclasses import dataclass
from typing import Literal

from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, Seconds
from runner.trajectories.blend import quintic_motion
from runner.trajectories.joint_motion import Configuration, JointMotion, configuration_of, start_of

_SAMPLES = 512


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


@dataclass(frozen=True)
class JointQuintic:
    r"""Synchronous motion of all joints from rest to rest, with u = t / t_f; see JointMotion for the attributes.

    .. math:: q(t) = q_0 + (q_f - q_0) (10 u^3 - 15 u^4 + 6 u^5)

    The peak speed of each joint is 1.875 |q_f - q_0| / t_f, at half time.

    Attributes:
        start: q_0, shape (nq,), in rad.
        goal: q_f, shape (nq,), in rad.
        duration: t_f, in s.
    """

    start: FloatArray
    goal: FloatArray
    duration: float
    samples: int = _SAMPLES

    def sample_joints(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests at the goal."""
        return quintic_motion(self.start, self.goal, self.duration, times)


CONFIG = JointQuinticConfig


def joint_motion(config: JointQuinticConfig, robot: Robot) -> JointMotion:
    """Build the motion that a config describes.

    Raises:
        ConfigError: if the length of a configuration differs from the number of joints.
    """
    goal = configuration_of("trajectory.goal_configuration", config.goal_configuration, robot)
    return JointQuintic(start_of(config.start_configuration, robot), goal, config.duration)
