"""Config of the torque notch filter."""

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.robots.by_joint import by_joint
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.per_stage import NotchPerStage


class NotchConfig(StrictModel):
    """Config of a second-order notch in the torques; see runner.controllers.notch.

    Attributes:
        frequency: Frequency of which nothing passes, in Hz. One for all joints or a list with one for each, by stage
            where the robot has several; None for joints without a notch.
        width: Distance of the frequencies at which 0.71 passes, in Hz.
    """

    frequency: NotchPerStage
    width: PositiveFloat

    def by_joint(self, arm: Robot) -> FloatArray:
        """Return the frequency of each joint, shape (nq,), in Hz; infinite where there is no notch.

        Raises:
            ConfigError: for values that do not fit the robot's stages and joints, or no notch at all.
        """
        frequency = by_joint("notch.frequency", self.frequency, arm)
        if not np.isfinite(frequency).any():
            raise ConfigError(
                ["notch.frequency: null for every joint; take notch=none for torques as the laws ask for them"]
            )
        return frequency
