"""Springs and motors of flexible joints around an engine for the links."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.decoupled import friction_by_joint
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.flexible_joints import Flexibility, FlexibleJoints, links_of
from runner.plants.motors import MotorFriction
from runner.plants.plant import Plant
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.values import FrictionConfig


class SeriesElastic(FlexibleJoints):
    r"""An arm with flexible joints, of which an engine moves the links.

    In each step of length h springs and dampers act by what they are at its start, on the links and, by semi-implicit
    Euler, on the motors:

    .. math:: \dot\theta_{n+1} = \dot\theta_n + h B^{-1} (\tau - K (\theta_n - q_n) - D (\dot\theta_n - \dot q_n)),
        \qquad \theta_{n+1} = \theta_n + h \dot\theta_{n+1}

    With an engine of the same scheme, as PyBullet and MuJoCo's Euler are, the whole is of first order and, undamped,
    symplectic: a mode is stable up to a rate of 2 / h, and no energy is lost or gained in the long run.

    Args:
        engine: Moves the links; one `advance` of it takes a step.
        model: The arm's rigid-body model, of the links alone.
        flexibility: Springs, dampers and motors of its joints.
        step: h, in s.
        steps_per_tick: Steps for which the torques of one tick are held.
    """

    def __init__(
        self, engine: Plant, model: RobotModel, flexibility: Flexibility, step: float, steps_per_tick: int
    ) -> None:
        super().__init__(model, flexibility, step, steps_per_tick)
        self._engine = engine
        self.q, self.dq = engine.q, engine.dq

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put links and motors into a state; see FlexibleJoints."""
        self._engine.reset(q, dq)
        super().reset(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector; see Plant."""
        super().set_gravity(gravity)
        self._engine.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques for one tick; see Plant."""
        on, h = self._on, self._step
        self._brake(on)
        for _ in range(self._steps_per_tick):
            spring = self.spring_torque()
            self._engine.advance(np.where(on, spring, tau) + self.load)
            self.dtheta[on] += h * self._free * (tau - spring)[on] / self._motors
            self.theta[on] += h * self.dtheta[on]
        self.theta[~on], self.dtheta[~on] = self.q[~on], self.dq[~on]

    def close(self) -> None:
        """Release what the engine holds."""
        self._engine.close()


def flexible_around(
    joints: FlexibleJointsConfig,
    friction: FrictionConfig,
    robot: Robot,
    step: float,
    steps_per_tick: int,
    make: Callable[[RobotModel], Plant],
) -> Plant:
    """Make the plant of a robot with flexible joints.

    Args:
        joints: Its springs and motors.
        friction: Friction in its motors.
        robot: The robot.
        step: Integration step, in s.
        steps_per_tick: Steps in a tick.
        make: Makes the engine that moves the links, of their model, with one step in a tick.
    """
    flexibility = joints.by_joint(robot)
    links = links_of(robot.model, flexibility.flexible)
    plant = SeriesElastic(make(links), links, flexibility, step, steps_per_tick)
    viscous, coulomb = friction_by_joint(robot, friction)
    rubs = viscous.any() or coulomb.any()
    return MotorFriction(plant, viscous, coulomb, step * steps_per_tick) if rubs else plant
