"""Config of the joint measurement."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from runner.config.per_stage import FinitePerStage, NonNegativePerStage, by_stage
from runner.config.problems import Problems
from runner.errors import ConfigError
from runner.registry import StrictModel
from runner.robots.robot import Robot
from runner.sensing import EncoderNoise

FloatArray = NDArray[np.float64]


class NoiseConfig(StrictModel):
    """Noise, bias and steps of the joint encoders.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of the joint-position noise, in rad, by
            stage where the robot has several.
        distribution: Its shape; with none, `position` has no effect.
        bias: Constant error of the measured joint positions, in rad, by stage where the robot has several: the same at
            every tick and in every repetition, as of a zero that is set wrong; of either sign.
        resolution: Step to which the biased, noisy joint positions are rounded, in rad, likewise; 0 for none.
        velocity: Whether joint velocities are exact or differences of the measured positions.
    """

    position: NonNegativePerStage
    distribution: Literal["uniform", "gaussian", "none"]
    bias: FinitePerStage = 0.0
    resolution: NonNegativePerStage = 0.0
    velocity: Literal["exact", "finite_difference"]

    def by_joint(self, arm: Robot) -> EncoderNoise:
        """Return the noise, bias and step of each joint of a robot.

        Raises:
            ConfigError: for values that do not fit the robot's stages.
        """
        problems = Problems()
        position = problems.attempt(self._expand, "position", arm)
        bias = problems.attempt(self._expand, "bias", arm)
        resolution = problems.attempt(self._expand, "resolution", arm)
        if position is None or bias is None or resolution is None:
            raise ConfigError(problems.found)
        return EncoderNoise(position, bias, resolution, self.distribution, self.velocity)

    def _expand(self, key: str, arm: Robot) -> FloatArray:
        """Return a value for each joint; one that was left out is zero for a robot of several stages, too."""
        joints = [stage.model.nq for stage in arm.stages]
        if key not in self.model_fields_set:
            return np.zeros(sum(joints))
        return np.repeat(by_stage(f"noise.{key}", getattr(self, key), arm.stage_names), joints)
