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
    """Config of every joint-space law.

    Attributes:
        task: Controlled tip motion: the position, or the pose with the orientation of home.
        natural_frequency: omega_n of the joints, which sets every gain of the law, and of the tip motion, in rad/s.
        damping_ratio: xi of the joints and of the tip motion.
        period: Time between two ticks, in s.
        gravity_compensation: True if the law includes the gravity term.
        feedforward: True if the law uses the desired velocity and acceleration; False to follow a moving goal.
        singularity_damping: Damping of the inverse of J near a singular configuration, as a fraction of the tip error;
            0 for no damping.
        null_space_frequency: omega_n of the posture task to home if the arm has redundant joints, in rad/s.
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
        config: Config of the law.
        rest: Home, for the posture task and for inertias that are computed once, shape (nq,), in rad.
        joints: True if the desired motion is a joint motion; see JointMotion.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions, or a list has the wrong length.
    """

    def __init__(self, model: RobotModel, config: C, rest: FloatArray, joints: bool = False) -> None:
        self._motion, self._remembers = JointMotion(model, config, rest, joints), 0
        numbers = self.choose_numbers(model, config, rest, self._motion.numbers)
        super().__init__([model], config.gravity_compensation, numbers)

    @abstractmethod
    def choose_numbers(self, model: RobotModel, config: C, rest: FloatArray, motion: JointMotionNumbers) -> N:
        """Return the numbers of the law, including `motion`.

        This also sets the attributes that select the equations, and `_remembers`, the size of the law's own memory.
        """

    def start(self, q: FloatArray) -> FloatArray:
        """Return the memories of the joint motion and of the law at the first tick; see TorqueLaw."""
        return np.concatenate([self._motion.start(q), self.own_start()])

    def own_start(self) -> FloatArray:
        """Return the law's own memory at the first tick, shape (remembers,); zero by default."""
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
        """Return the torques, and the memories of the joint motion and of the law; see TorqueLaw."""
        (arm,) = arms
        own = len(memory) - self._remembers
        desired, goes_on = self._motion.follow(arm, numbers.motion, reference, memory[:own])
        torque, kept = self.command(arm, numbers, q, dq, desired, memory[own:])
        return torque, np.concatenate([goes_on, kept])

    @abstractmethod
    def command(
        self, arm: Arm, numbers: N, q: Array, dq: Array, desired: DesiredJoints, memory: Array
    ) -> tuple[Array, Array]:
        """Return the torques, shape (nq,), in N m, and the law's own memory for the next tick.

        Args:
            arm: Nominal arm.
            numbers: Numbers of the law.
            q: Measured joint positions, shape (nq,), in rad.
            dq: Measured joint velocities, shape (nq,), in rad/s.
            desired: Desired joint motion.
            memory: The law's own memory, shape (remembers,).
        """


def joint_law_builder(
    law: Callable[[RobotModel, C, FloatArray, bool], Controller],
) -> Callable[..., tuple[Loop, ...]]:
    """Return the `build` of a module from its law, a function of (arm, config, home, joints)."""

    def build(config: C, robot: Robot, joints: bool = False) -> tuple[Loop, ...]:
        """Build the single loop of a config; it commands every joint.

        Raises:
            ConfigError: see the law.
        """
        made = law(robot.model, config, robot.home, joints)
        return (Loop("whole", slice(0, robot.model.nq), config.period, made, follows_joints=joints),)

    return build


def start_posture(config: JointLawConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return the joint positions at the start; see task_start."""
    return task_start(config.task, robot, start)
