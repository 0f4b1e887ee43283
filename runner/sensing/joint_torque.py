"""Joint torque sensors on the link side of the joint friction."""

import numpy as np
from pydantic import FiniteFloat, NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import JointTorque
from runner.schema.values import expand


class JointTorqueConfig(StrictModel):
    """Config of the torque sensors in the joints.

    Attributes:
        noise: Standard deviation of each reading, in N m; N where a joint slides. One for all joints or a list with one
            for each; None where there are no sensors.
        bias: Constant error of each reading, in N m; N where a joint slides. Likewise.
    """

    noise: JointTorque[NonNegativeFloat | list[NonNegativeFloat] | None]
    bias: JointTorque[FiniteFloat | list[FiniteFloat]]

    def by_joint(self, arm: Robot) -> tuple[FloatArray, FloatArray] | None:
        """Return noise and bias of each joint of a robot, shapes (nq,), in N m; None where there are no sensors.

        Raises:
            ConfigError: for a list of another length; names the joints.
        """
        if self.noise is None:
            return None
        joints = arm.model.joint_names
        noise = expand("joint_torque_sensor.noise", self.noise, joints)
        return np.array(noise), np.array(expand("joint_torque_sensor.bias", self.bias, joints))


class JointTorqueSensor:
    """Readings of the torques that the drives put on the links: what they give, less the friction of the joints.

    All draws are made when the sensor is made; a longer run starts alike.

    Args:
        ticks: Number of readings to come.
        noise: Standard deviation of each joint's reading, shape (nq,), in N m.
        bias: Constant error, shape (nq,), in N m.
        generator: Source of the draws.
    """

    def __init__(self, ticks: int, noise: FloatArray, bias: FloatArray, generator: np.random.Generator) -> None:
        self._errors = bias + noise * generator.standard_normal((ticks, len(noise)))

    def read(self, tick: int, torque: FloatArray) -> FloatArray:
        """Return the reading at a tick of the mean torques since the last one, shapes (nq,), in N m."""
        reading: FloatArray = torque + self._errors[tick]
        return reading
