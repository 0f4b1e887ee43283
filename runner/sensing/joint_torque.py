"""Joint torque sensors on the link side of the joint friction."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import FiniteFloat, NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import JointTorque
from runner.schema.values import expand


class JointTorqueConfig(StrictModel):
    """Config of the joint torque sensors.

    Attributes:
        kind: Name in the registry.
        noise: Standard deviation of each reading, in N m; N for prismatic joints. One value for all joints, or a list
            with one for each joint; None for no sensors.
        bias: Constant error of each reading, in N m; N for prismatic joints. One value for all joints, or a list with
            one for each joint.
    """

    kind: Literal["joint_torque"] = "joint_torque"
    noise: JointTorque[NonNegativeFloat | list[NonNegativeFloat] | None]
    bias: JointTorque[FiniteFloat | list[FiniteFloat]]

    def by_joint(self, units: Mapping[str, Mapping[str, str]]) -> "JointTorqueNoise | None":
        """Return the noise and bias of each joint of a robot; None if there are no sensors.

        Args:
            units: Unit of the position of each joint by name, rad or m, by stage.

        Raises:
            ConfigError: if the length of a list differs from the number of joints; the message contains their names.
        """
        if self.noise is None:
            return None
        joints = [name for stage in units.values() for name in stage]
        noise = expand("joint_torque_sensor.noise", self.noise, joints)
        bias = expand("joint_torque_sensor.bias", self.bias, joints)
        return JointTorqueNoise(np.array(noise), np.array(bias), self.kind)


@dataclass(frozen=True)
class JointTorqueNoise:
    """Errors of joint torque sensors.

    Attributes:
        noise: Standard deviation of the reading of each joint, shape (nq,), in N m.
        bias: Constant error of each joint, shape (nq,), in N m.
        kind: Name in the registry.
    """

    noise: FloatArray
    bias: FloatArray
    kind: str = "joint_torque"


class JointTorqueSensor:
    """Readings of the torques on the links: the torques of the drives minus the joint friction.

    The constructor draws all random numbers, so the start of a longer run is the same.

    Args:
        ticks: Number of readings.
        errors: Noise and bias.
        generator: Random generator.
    """

    def __init__(self, ticks: int, errors: JointTorqueNoise, generator: np.random.Generator) -> None:
        self._errors = errors.bias + errors.noise * generator.standard_normal((ticks, len(errors.noise)))

    def read(self, tick: int, torque: FloatArray) -> FloatArray:
        """Return the reading at a tick, from the mean torques since the last tick, shapes (nq,), in N m."""
        reading: FloatArray = torque + self._errors[tick]
        return reading


CONFIG = JointTorqueConfig
by_joint = JointTorqueConfig.by_joint


def build(
    errors: JointTorqueNoise, joints: tuple[str, ...], ticks: int, generator: np.random.Generator
) -> JointTorqueSensor:
    """Build the sensors of a run from their errors by joint."""
    return JointTorqueSensor(ticks, errors, generator)
