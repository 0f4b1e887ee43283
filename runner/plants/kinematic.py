"""Kinematic plant: ideal joint position servos with speed limits."""

from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.plants.computation import ComputationConfig
from runner.plants.plant import Plant, PositionPlant
from runner.plants.servo import SetPoints
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.model import StrictModel

COMMANDS = "position"


class KinematicConfig(StrictModel):
    """Config of the kinematic plant.

    Attributes:
        kind: Name in the registry.
        step: None: nothing is integrated.
        wrist_rotation: The base stage always rotates the base of the mounted stage.
        computation: Delay of the commands, the same for all.
    """

    kind: Literal["kinematic"]
    step: None
    wrist_rotation: Literal["real"]
    computation: ComputationConfig


class Kinematic(PositionPlant):
    """Joints that follow commanded positions exactly, at constant speed within a command, up to the speed limits.

    The torques are the inverse dynamics of that motion under the external load, without limits.

    Args:
        model: Rigid-body model of the arm.
        tick: Duration of one call of `advance`, in s.
        ticks_per_command: Ticks from one command to the next.
    """

    def __init__(self, model: RobotModel, tick: float, ticks_per_command: int) -> None:
        self._model, self._data = model.separate()
        self._tick = tick
        self._set_points = SetPoints(ticks_per_command, tick, model.velocity_limits, interpolate=True)
        self.q = np.zeros(model.nq)
        self.dq = np.zeros(model.nq)
        self.tau = np.zeros(model.nq)
        self.load = np.zeros(model.nq)

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state; see Plant."""
        self.q[:], self.dq[:] = q, dq
        self._set_points.reset(q)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._model.gravity.linear = gravity

    def advance(self, command: FloatArray) -> None:
        """Move towards the commanded joint positions for one tick; see PositionPlant."""
        self._set_points.advance(command)
        dq = self._set_points.velocity
        ddq = (dq - self.dq) / self._tick
        self.tau[:] = pin.rnea(self._model, self._data, self.q, dq, ddq) - self.load
        self.q[:], self.dq[:] = self._set_points.position, dq


CONFIG = KinematicConfig


def build(config: KinematicConfig, robot: Robot, tick: float, ticks_per_command: int) -> Plant:
    """Build the plant of a config."""
    return Kinematic(robot.model, tick, ticks_per_command)
