"""Config of the joint measurement."""

from typing import Literal

import numpy as np

from runner.config.per_stage import NonNegativePerStage, by_stage
from runner.config.problems import Problems
from runner.errors import ConfigError
from runner.registry import StrictModel
from runner.robots.robot import Robot
from runner.sensing import EncoderNoise


class NoiseConfig(StrictModel):
    """Noise and steps of the joint encoders.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of the joint-position noise, in rad, by
            stage where the robot has several.
        distribution: Its shape; with none, `position` has no effect.
        resolution: Step to which the noisy joint positions are rounded, in rad, likewise; 0 for none.
        velocity: Whether joint velocities are exact or differences of the measured positions.
    """

    position: NonNegativePerStage
    distribution: Literal["uniform", "gaussian", "none"]
    resolution: NonNegativePerStage = 0.0
    velocity: Literal["exact", "finite_difference"]

    def by_joint(self, arm: Robot) -> EncoderNoise:
        """Return the noise of each joint of a robot.

        Raises:
            ConfigError: for values that do not fit the robot's stages.
        """
        joints = [stage.model.nq for stage in arm.stages]
        problems = Problems()
        position = problems.attempt(lambda: by_stage("noise.position", self.position, arm.stage_names))
        resolution = problems.attempt(lambda: by_stage("noise.resolution", self.resolution, arm.stage_names))
        if position is None or resolution is None:
            raise ConfigError(problems.found)
        return EncoderNoise(
            np.repeat(position, joints), np.repeat(resolution, joints), self.distribution, self.velocity
        )
