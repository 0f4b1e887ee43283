"""Config of each joint: noise, bias and resolution of its encoder, and its torque limit."""

import math
from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.config.arms import RobotOutline
from runner.config.parsing import Problems, require
from runner.robots.robot import by_joint
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, JointTorque, RadiansPerSecond
from runner.schema.values import FinitePerStage, NonNegativePerStage, TorquePerStage, by_stage
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
        # An omitted key is zero, also for a robot of several stages.
        zero: float | dict[str, float] = dict.fromkeys(arm.stage_names, 0.0) if len(arm.stages) > 1 else 0.0
        biases = self.bias if "bias" in self.model_fields_set else zero
        steps = self.resolution if "resolution" in self.model_fields_set else zero
        problems = Problems()
        position = problems.attempt(_by_joint, "noise.position", self.position, arm)
        bias = problems.attempt(_by_joint, "noise.bias", biases, arm)
        resolution = problems.attempt(_by_joint, "noise.resolution", steps, arm)
        problems.report()
        values = require(position), require(bias), require(resolution)
        return EncoderNoise(*values, self.distribution, self.velocity, self.velocity_bandwidth)


def _by_joint(key: str, value: float | dict[str, float], arm: RobotOutline) -> FloatArray:
    """Return the value of each joint; reject an error of more than half a turn of a revolute joint."""
    values: list[float] = by_stage(key, value, arm.stage_names)
    problems = [
        f"{key}{f'.{stage.name}' if len(arm.stages) > 1 else ''}: {value:g} rad is more than half a turn, and no "
        f"measurement of an angle; degrees? write {value:g}deg"
        for stage, value in zip(arm.stages, values, strict=True)
        if abs(value) > math.pi and "rad" in stage.joint_units
    ]
    if problems:
        raise ConfigError(problems)
    return np.repeat(values, [len(stage.joint_names) for stage in arm.stages])


def exact_encoders(joints: int) -> EncoderNoise:
    """Return zero noise, for a robot whose encoders are a plug-in, by the number of joints."""
    zero = np.zeros(joints)
    return EncoderNoise(zero, zero, zero, "none", "exact")


class TorqueLimitsConfig(StrictModel):
    """Limits of the joint torques.

    Attributes:
        max: Largest magnitude of the torque, in N m; N for prismatic joints. One value for all joints, or a list with
            one for each; by stage if the robot has several. None for no limit.
    """

    max: JointTorque[TorquePerStage | None]

    def by_joint(self, arm: RobotOutline) -> FloatArray:
        """Return the limit of each joint of a robot, shape (nq,), in N m: the effort in the URDF if it is smaller.

        Raises:
            ConfigError: for values that do not fit the robot's stages and joints.
        """
        return np.minimum(by_joint("torque_limits.max", self.max, arm.stage_joints), arm.effort_limits)
