"""Constant joint torques without feedback, for comparisons of plants in open loop."""

from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Controller, Loop
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import JointTorque, Seconds
from runner.schema.values import expand


class HeldTorquesConfig(StrictModel):
    """Config of held torques.

    Attributes:
        kind: Its name in the registry.
        period: Time between two ticks, in s.
        torques: Of every joint or one for each, in N m, or in N for a prismatic joint.
    """

    kind: Literal["held_torques"]
    period: Seconds[PositiveFloat]
    torques: JointTorque[float | list[float]]


class HeldTorques(Controller):
    """The law that does nothing with what is measured.

    Args:
        torques: In N m or N, shape (nq,).
    """

    def __init__(self, torques: FloatArray) -> None:
        self._torques = torques

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques; see Controller.torque."""
        return self._torques


CONFIG = HeldTorquesConfig


def build(config: HeldTorquesConfig, robot: Robot) -> tuple[Loop, ...]:
    """Make the one loop that a config describes.

    Raises:
        ConfigError: if a list has not one torque for each joint.
    """
    model = robot.model
    torques = np.array(expand("controller.torques", config.torques, model.joint_names))
    return (Loop("held torques", slice(0, model.nq), config.period, HeldTorques(torques)),)
