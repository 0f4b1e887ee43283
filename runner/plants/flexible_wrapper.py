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
    r"""An arm with flexible joints whose links are moved by a physics engine.

    In each step of length h, the torques of springs and dampers at its start act on the links. They also act on the
    motors, by semi-implicit Euler:

    .. math:: \dot\theta_{n+1} = \dot\theta_n + h B^{-1} (\tau - K (\theta_n - q_n) - D (\dot\theta_n - \dot q_n)),
        \qquad \theta_{n+1} = \theta_n + h \dot\theta_{n+1}

    With an engine of the same scheme (PyBullet, MuJoCo's Euler), the whole scheme is of first order. Undamped, it is
    symplectic: a mode is stable up to a rate of 2 / h, and energy is conserved in the long run.

    Args:
        engine: Plant of the links; one call of `advance` takes one step.
        model: Rigid-body model of the links.
        flexibility: Springs, dampers and motors of the joints.
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
        """Reset links and motors to a state; see FlexibleJoints."""
        self._engine.reset(q, dq)
        super().reset(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
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
        """Release the resources of the engine."""
        self._engine.close()


def flexible_around(
    joints: FlexibleJointsConfig,
    friction: FrictionConfig,
    robot: Robot,
    step: float,
    steps_per_tick: int,
    make: Callable[[RobotModel], Plant],
) -> Plant:
    """Build the plant of a robot with flexible joints.

    Args:
        joints: Config of springs and motors.
        friction: Friction in the motors.
        robot: The robot.
        step: Integration step, in s.
        steps_per_tick: Steps in a tick.
        make: Function that builds the engine of the links from their model, with one step in a tick.
    """
    flexibility = joints.by_joint(robot)
    links = links_of(robot.model, flexibility.flexible)
    plant = SeriesElastic(make(links), links, flexibility, step, steps_per_tick)
    viscous, coulomb = friction_by_joint(robot, friction)
    rubs = viscous.any() or coulomb.any()
    return MotorFriction(plant, viscous, coulomb, step * steps_per_tick) if rubs else plant
