"""Joint torque sensors on the link side of the joint friction."""

import numpy as np
from pydantic import FiniteFloat, NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import JointTorque
from runner.schema.values import expand


class JointTorqueConfig(StrictModel):
    """Config of the joint torque sensors.

    Attributes:
        noise: Standard deviation of each reading, in N m; N for prismatic joints. One value for all joints, or a list
            with one for each joint; None for no sensors.
        bias: Constant error of each reading, in N m; N for prismatic joints. One value for all joints, or a list with
            one for each joint.
    """

    noise: JointTorque[NonNegativeFloat | list[NonNegativeFloat] | None]
    bias: JointTorque[FiniteFloat | list[FiniteFloat]]

    def by_joint(self, arm: Robot) -> tuple[FloatArray, FloatArray] | None:
        """Return the noise and bias of each joint of a robot, shapes (nq,), in N m; None if there are no sensors.

        Raises:
            ConfigError: if the length of a list differs from the number of joints; the message contains their names.
        """
        if self.noise is None:
            return None
        joints = arm.model.joint_names
        noise = expand("joint_torque_sensor.noise", self.noise, joints)
        return np.array(noise), np.array(expand("joint_torque_sensor.bias", self.bias, joints))


class JointTorqueSensor:
    """Readings of the torques on the links: the torques of the drives minus the joint friction.

    The constructor draws all random numbers, so the start of a longer run is the same.

    Args:
        ticks: Number of readings.
        noise: Standard deviation of the reading of each joint, shape (nq,), in N m.
        bias: Constant error of each joint, shape (nq,), in N m.
        generator: Random generator.
    """

    def __init__(self, ticks: int, noise: FloatArray, bias: FloatArray, generator: np.random.Generator) -> None:
        self._errors = bias + noise * generator.standard_normal((ticks, len(noise)))

    def read(self, tick: int, torque: FloatArray) -> FloatArray:
        """Return the reading at a tick, from the mean torques since the last tick, shapes (nq,), in N m."""
        reading: FloatArray = torque + self._errors[tick]
        return reading
