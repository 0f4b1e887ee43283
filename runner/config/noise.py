"""Config of the joint encoders: noise, bias and resolution."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.errors import ConfigError
from runner.config.arms import RobotOutline
from runner.config.compose.problems import Problems
from runner.schema.model import StrictModel
from runner.schema.per_stage import FinitePerStage, NonNegativePerStage, by_stage
from runner.schema.units import JointPosition, RadiansPerSecond
from runner.sensing import EncoderNoise
from runner.sensing.velocity import DEFAULT_BANDWIDTH, Velocity


class NoiseConfig(StrictModel):
    """Noise, bias and resolution of the joint encoders.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of the joint-position noise, in rad; m for
            prismatic joints. By stage if the robot has several.
        distribution: Distribution of the noise; with none, `position` has no effect.
        bias: Constant error of the measured joint positions, such as a wrong zero, in rad; m for prismatic joints. By
            stage if the robot has several. It has either sign and is the same at every tick and in every repetition.
        resolution: Step to which the biased, noisy joint positions are rounded, in rad; m for prismatic joints. By
            stage if the robot has several; 0 for no rounding.
        velocity: Source of joint velocities: exact, differences of the measured positions, the same after a first-order
            low-pass, or a Luenberger observer of each joint.
        velocity_bandwidth: Cut-off of the low-pass, and both poles of the observer, in rad/s.
    """

    position: JointPosition[NonNegativePerStage]
    distribution: Literal["uniform", "gaussian", "none"]
    bias: JointPosition[FinitePerStage] = 0.0
    resolution: JointPosition[NonNegativePerStage] = 0.0
    velocity: Velocity
    velocity_bandwidth: RadiansPerSecond[PositiveFloat] = DEFAULT_BANDWIDTH

    def by_joint(self, arm: RobotOutline) -> EncoderNoise:
        """Return the noise, bias and resolution of each joint of a robot.

        Raises:
            ConfigError: for values that do not fit the robot's stages.
        """
        names, joints = arm.stage_names, [len(stage.joint_names) for stage in arm.stages]
        # An omitted key is zero, also for a robot of several stages.
        zero: float | dict[str, float] = dict.fromkeys(names, 0.0) if len(names) > 1 else 0.0
        biases = self.bias if "bias" in self.model_fields_set else zero
        steps = self.resolution if "resolution" in self.model_fields_set else zero
        problems = Problems()
        position = problems.attempt(lambda: by_stage("noise.position", self.position, names))
        bias = problems.attempt(lambda: by_stage("noise.bias", biases, names))
        resolution = problems.attempt(lambda: by_stage("noise.resolution", steps, names))
        if position is None or bias is None or resolution is None:
            raise ConfigError(problems.found)
        for key, values in (("position", position), ("bias", bias), ("resolution", resolution)):
            problems.found += _no_angles(f"noise.{key}", values, arm)
        problems.report()
        return EncoderNoise(
            np.repeat(position, joints),
            np.repeat(bias, joints),
            np.repeat(resolution, joints),
            self.distribution,
            self.velocity,
            self.velocity_bandwidth,
        )


def _no_angles(key: str, values: Sequence[float], arm: RobotOutline) -> list[str]:
    """Return a problem for each stage whose revolute joints have an error of more than half a turn."""
    several = len(arm.stages) > 1
    return [
        f"{key}{f'.{stage.name}' if several else ''}: {value:g} rad is more than half a turn, and no measurement of an "
        f"angle; degrees? write {value:g}deg"
        for stage, value in zip(arm.stages, values, strict=True)
        if abs(value) > math.pi and "rad" in stage.joint_units
    ]


def exact_encoders(joints: int) -> EncoderNoise:
    """Return zero noise, for a robot whose encoders are a plug-in, by the number of joints."""
    zero = np.zeros(joints)
    return EncoderNoise(zero, zero, zero, "none", "exact")
