"""Runge-Kutta plant: integrated equations of motion."""

from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.plants.compiled_motion import compile_motion
from runner.plants.decoupled import Motion, TorquePlantConfig, assemble_plant, find_motion
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.flexible_joints import FlexibleJoints, links_of
from runner.plants.motors import MotorFriction
from runner.plants.plant import Plant
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
        self._compiled = compile_motion(model, step)
        self._model = pin.Model(model.pin_model)
        # Each stage has separate data, because aba returns a view into it.
        self._data = [self._model.createData() for _ in range(4)]
        self._step = step
        self._steps_per_tick = steps_per_tick
        self.q = np.zeros(model.nq)
        self.dq = np.zeros(model.nq)

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
            self._compiled.advance(self.q, self.dq, tau, self._steps_per_tick)
            return
        model, h = self._model, self._step
        data1, data2, data3, data4 = self._data
        half = 0.5 * h
        q, v = self.q, self.dq
        for _ in range(self._steps_per_tick):
            # Because dq = v, the slopes of the positions are the intermediate velocities. Four accelerations suffice:
            # q+ = q + h v + h^2/6 (a1 + a2 + a3), v+ = v + h/6 (a1 + 2 a2 + 2 a3 + a4).
            a1 = pin.aba(model, data1, q, v, tau)
            v2 = v + half * a1
            a2 = pin.aba(model, data2, q + half * v, v2, tau)
            v3 = v + half * a2
            a3 = pin.aba(model, data3, q + half * v2, v3, tau)
            a4 = pin.aba(model, data4, q + h * v3, v + h * a3, tau)
            total = a1 + a2
            total += a3
            q += h * v + (h * h / 6.0) * total
            total += a2
            total += a3
            total += a4
            v += (h / 6.0) * total


CONFIG = Rk4Config


def build(config: Rk4Config, robot: Robot, step: float, steps_per_tick: int) -> Plant:
    """Build the plant of a config."""
    tick = step * steps_per_tick
    if config.flexible_joints is not None:
        (arm,) = find_motion(robot, config).arms
        flexibility = config.flexible_joints.by_joint(robot)
        springs = FlexibleJoints(links_of(arm.model, flexibility.flexible), flexibility, step, steps_per_tick)
        rubs = arm.viscous.any() or arm.coulomb.any()
        return MotorFriction(springs, arm.viscous, arm.coulomb, tick) if rubs else springs
    return assemble_plant(config, robot, tick, lambda _, model: Rk4(model, step, steps_per_tick))


def motion(config: Rk4Config, robot: Robot) -> Motion | None:
    """Return the motion that the plant integrates; None for flexible joints."""
    return None if config.flexible_joints is not None else find_motion(robot, config)


def moves_exactly(config: Rk4Config) -> bool:
    """Return True: the scheme is of fourth order."""
    return True
