"""Base classes and builder of joint-space control laws."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Controller, Loop
from runner.controllers.joint_space.joint_motion import DesiredJoints, JointMotion, JointMotionNumbers
from runner.controllers.operational_space.tip_task import TaskName, task_start
from runner.controllers.torque_law import Arm, TorqueLaw
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import RadiansPerSecond, Seconds
from runner.symbolic.maths import Array, Scalar


class JointLawConfig(StrictModel):
    """What the config of every law in joint space says.

    Attributes:
        task: Whether the tip's position is led, or its pose, with home's orientation held.
        natural_frequency: omega_n of the joints, from which every gain of the law follows, and of the motion that leads
            the tip, in rad/s.
        damping_ratio: xi of both.
        period: Time between two ticks, in s.
        gravity_compensation: Whether the law holds the gravity term.
        feedforward: Whether the law follows the desired velocity and acceleration, or sees a moving goal.
        singularity_damping: Share of the tip's error by which the inverse of J is damped near a singular posture;
            0 is the law without damping.
        null_space_frequency: omega_n of the posture task, home, of an arm with more joints than the task needs, in
            rad/s.
    """

    task: TaskName
    natural_frequency: RadiansPerSecond[PositiveFloat]
    damping_ratio: PositiveFloat
    period: Seconds[PositiveFloat]
    gravity_compensation: bool
    feedforward: bool
    singularity_damping: NonNegativeFloat
    null_space_frequency: RadiansPerSecond[NonNegativeFloat]


N = TypeVar("N", bound=Any)  # a NamedTuple with the numbers of the motion, `motion`
C = TypeVar("C", bound=JointLawConfig)


class JointLaw(TorqueLaw[N], Generic[N, C]):
    """A torque law that follows the desired joints of a JointMotion.

    Args:
        model: The arm.
        config: The law's numbers.
        rest: Home: posture of the null space, and of inertias that are taken once, shape (nq,), in rad.
        joints: Whether the desired motion is one of the joints; see JointMotion.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions, or a list of the config another length.
    """

    def __init__(self, model: RobotModel, config: C, rest: FloatArray, joints: bool = False) -> None:
        self._motion, self._remembers = JointMotion(model, config, rest, joints), 0
        numbers = self.choose_numbers(model, config, rest, self._motion.numbers)
        super().__init__([model], config.gravity_compensation, numbers)

    @abstractmethod
    def choose_numbers(self, model: RobotModel, config: C, rest: FloatArray, motion: JointMotionNumbers) -> N:
        """Return the law's numbers, of which one is `motion`.

        It sets the attributes that decide how the law goes, beside its numbers; `_remembers` is how many numbers the
        law itself keeps from tick to tick, zeros at the first one.
        """

    def start(self, q: FloatArray) -> FloatArray:
        """Return the joint motion where it starts, and what the law itself keeps; see TorqueLaw."""
        return np.concatenate([self._motion.start(q), self.own_start()])

    def own_start(self) -> FloatArray:
        """Return what the law itself keeps, at the first tick, shape (remembers,)."""
        return np.zeros(self._remembers)

    def evaluate(
        self,
        arms: Sequence[Arm],
        numbers: N,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        memory: Array,
    ) -> tuple[Array, Array]:
        """Return the torques, and the joint motion and the law's own memory at the next tick; see TorqueLaw."""
        (arm,) = arms
        own = len(memory) - self._remembers
        desired, goes_on = self._motion.follow(arm, numbers.motion, reference, memory[:own])
        torque, kept = self.command(arm, numbers, q, dq, desired, memory[own:])
        return torque, np.concatenate([goes_on, kept])

    @abstractmethod
    def command(
        self, arm: Arm, numbers: N, q: Array, dq: Array, desired: DesiredJoints, memory: Array
    ) -> tuple[Array, Array]:
        """Return the torques, shape (nq,), in N m, and what the law itself keeps for the next tick.

        Args:
            arm: The law's nominal arm.
            numbers: The law's numbers.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            desired: What is followed.
            memory: What the law itself kept, shape (remembers,).
        """


def joint_law_builder(
    law: Callable[[RobotModel, C, FloatArray, bool], Controller],
) -> Callable[..., tuple[Loop, ...]]:
    """Return the `build` of a module, from its law of (arm, config, home, whether joints lead)."""

    def build(config: C, robot: Robot, joints: bool = False) -> tuple[Loop, ...]:
        """Make the one loop that a config describes; it commands every joint.

        Raises:
            ConfigError: see the law.
        """
        made = law(robot.model, config, robot.home, joints)
        return (Loop("whole", slice(0, robot.model.nq), config.period, made, follows_joints=joints),)

    return build


def start_posture(config: JointLawConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return where the arm stands at a trajectory's start: for a pose, with home's orientation."""
    return task_start(config.task, robot, start)
