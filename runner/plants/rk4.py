"""Runge-Kutta plant: integrated equations of motion."""

from functools import partial
from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.plants.compiled_motion import CompiledStep
from runner.plants.decoupled import Motion, TorquePlantConfig, assemble_flexible, assemble_plant, find_motion
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.flexible_config import modes as modes
from runner.plants.plant import Plant
from runner.plants.runge_kutta import runge_kutta
from runner.robots.model import RobotModel
from runner.robots.robot import Robot


class Rk4Config(TorquePlantConfig):
    """Config of the Runge-Kutta plant.

    Attributes:
        kind: Name in the registry.
        step: Integration step, in s; None selects the fastest controller period.
        flexible_joints: Springs between motors and links; None for rigid joints.
    """

    kind: Literal["rk4"]
    flexible_joints: FlexibleJointsConfig | None = None


class Rk4(Plant):
    """An arm integrated by the classical Runge-Kutta scheme.

    Accelerations come from compiled code if available, else from Pinocchio's articulated-body algorithm. The scheme is
    of fourth order in its step if the torques are held and the motion is smooth: no contact, no stops.

    Args:
        model: Rigid-body model of the arm.
        step: Integration step, in s.
        steps_per_tick: Integration steps for which the torques of one tick are held.
    """

    def __init__(self, model: RobotModel, step: float, steps_per_tick: int) -> None:
        self._compiled = CompiledStep.compile(model, step)
        self._model, self._data = model.separate()
        self._step = step
        self._steps_per_tick = steps_per_tick
        self._state = np.zeros(2 * model.nq)
        self.q, self.dq = np.split(self._state, 2)

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state; see Plant."""
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._model.gravity.linear = gravity
        if self._compiled is not None:
            self._compiled.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        if self._compiled is not None:
            self._compiled.advance(self._state, tau, self._steps_per_tick)
        else:
            slope = partial(self._slope, tau=tau)
            self._state[:] = runge_kutta(slope, self._state, self._step, self._steps_per_tick)

    def _slope(self, x: FloatArray, tau: FloatArray) -> FloatArray:
        """Return the time derivative of the state: joint positions, then joint velocities."""
        q, dq = x[: len(tau)], x[len(tau) :]
        return np.concatenate([dq, pin.aba(self._model, self._data, q, dq, tau)])


CONFIG = Rk4Config


def build(config: Rk4Config, robot: Robot, step: float, steps_per_tick: int) -> Plant:
    """Build the plant of a config."""
    if config.flexible_joints is not None:
        return assemble_flexible(config, config.flexible_joints, robot, step, steps_per_tick)
    return assemble_plant(config, robot, step * steps_per_tick, lambda _, model: Rk4(model, step, steps_per_tick))


def motion(config: Rk4Config, robot: Robot, step: float, steps_per_tick: int) -> Motion | None:
    """Return the motion that the plant integrates, at any step; None for flexible joints."""
    return None if config.flexible_joints is not None else find_motion(robot, config)


def moves_exactly(config: Rk4Config) -> bool:
    """Return True: the scheme is of fourth order."""
    return True
