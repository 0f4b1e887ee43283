"""Config of the notch in the torques."""

import numpy as np
from pydantic import PositiveFloat

from runner.config.per_joint import expand
from runner.config.per_stage import NotchPerStage, by_stage
from runner.controllers.controller import FloatArray
from runner.errors import ConfigError
from runner.registry import StrictModel
from runner.robots.robot import Robot


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
        key, several = "notch.frequency", len(arm.stages) > 1
        values: list[float | None] = []
        for stage, given in zip(arm.stages, by_stage(key, self.frequency, arm.stage_names), strict=True):
            at = f"{key}.{stage.name}" if several else key
            values += expand(at, given, stage.model.joint_names)  # type: ignore[arg-type]
        if all(each is None for each in values):
            raise ConfigError([f"{key}: null for every joint; take notch=none for torques as the laws ask for them"])
        return np.array([np.inf if each is None else each for each in values])
