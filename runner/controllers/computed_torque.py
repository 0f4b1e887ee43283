"""Computed-torque control: joints follow a joint motion that is resolved from the tip's."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.controllers.controller import FloatArray, Loop
from runner.controllers.joint_motion import JointMotion, JointMotionNumbers
from runner.controllers.maths import Array, Scalar
from runner.controllers.tip_task import TaskName, task_start
from runner.controllers.torque_law import Arm, TorqueLaw
from runner.registry import StrictModel
from runner.robots.model import RobotModel
from runner.robots.robot import Robot


class ComputedTorqueConfig(StrictModel):
    """Config of computed-torque control.

    Attributes:
        kind: Its name in the registry.
        task: Whether the tip's position is led, or its pose, with home's orientation held.
        natural_frequency: omega_n of every joint's closed loop, and of the motion that leads the tip, in rad/s.
        damping_ratio: xi of both.
        period: Time between two ticks, in s.
        gravity_compensation: Whether the law holds the gravity term.
        feedforward: Whether the law follows the desired velocity and acceleration, or sees a moving goal.
        singularity_damping: Share of the tip's error by which the inverse of J is damped near a singular posture;
            0 is the law without damping.
        null_space_frequency: omega_n of the posture task, home, of an arm with more joints than the task needs, in
            rad/s.
        integral_gain: How fast the integral of each joint's error acts, k_i in 1/s^3; 0 is the law without it.
    """

    kind: Literal["computed_torque"]
    task: TaskName
    natural_frequency: PositiveFloat
    damping_ratio: PositiveFloat
    period: PositiveFloat
    gravity_compensation: bool
    feedforward: bool
    singularity_damping: NonNegativeFloat
    null_space_frequency: NonNegativeFloat
    integral_gain: NonNegativeFloat


class ComputedTorqueNumbers(NamedTuple):
    """The numbers of computed-torque control.

    Attributes:
        motion: Of the joint motion that is followed.
        k_p: omega_n^2, in 1/s^2.
        k_v: 2 xi omega_n, in 1/s.
        k_i: Of the integral, in 1/s^3.
    """

    motion: JointMotionNumbers
    k_p: Scalar
    k_v: Scalar
    k_i: Scalar


class ComputedTorque(TorqueLaw[ComputedTorqueNumbers]):
    r"""Inverse dynamics in joint space (Luh, Walker and Paul, IEEE Transactions on Automatic Control 25(3), 1980).

    .. math:: \tau = M (\ddot q_d + 2 \xi \omega_n (\dot q_d - \dot q) + \omega_n^2 (q_d - q) + k_i z) + V + G

    Under an exact model each joint's error obeys eq. (3.36) of the thesis, whatever the posture and speed. The integral
    z of q_d - q, tick by tick, takes away what a wrong model or a constant load leaves at rest; the closed loop is
    stable for k_i < 2 xi omega_n^3, and winds up while a torque is at its limit. Without it k_i is 0. JointMotion says
    what q_d is.

    Args:
        model: The arm.
        config: The law's numbers.
        rest: Posture of the null space, shape (nq,), in rad.
        joints: Whether the desired motion is one of the joints.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: ComputedTorqueConfig, rest: FloatArray, joints: bool = False) -> None:
        self._motion = JointMotion(model, config, rest, joints)
        self._integrates = config.integral_gain > 0.0
        numbers = ComputedTorqueNumbers(
            motion=self._motion.numbers,
            k_p=config.natural_frequency**2,
            k_v=2.0 * config.damping_ratio * config.natural_frequency,
            k_i=config.integral_gain,
        )
        super().__init__([model], config.gravity_compensation, numbers)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the joint motion where it starts, and z = 0, shape (3 nq,); where joints are followed z alone."""
        return np.concatenate([self._motion.start(q), np.zeros(len(q))])

    def evaluate(
        self,
        arms: Sequence[Arm],
        numbers: ComputedTorqueNumbers,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        memory: Array,
    ) -> tuple[Array, Array]:
        """Return the torques of the law above, and the joint motion at the next tick; see TorqueLaw."""
        (arm,), n = arms, len(q)
        (q_d, dq_d, ddq_d), goes_on = self._motion.follow(arm, numbers.motion, reference, memory[:-n])
        z, error = memory[-n:], q_d - q
        ddq = ddq_d + numbers.k_v * (dq_d - dq) + numbers.k_p * error
        if self._integrates:
            ddq, z = ddq + numbers.k_i * z, z + numbers.motion.period * error
        return arm.inverse_dynamics(q, dq, ddq), np.concatenate([goes_on, z])


CONFIG = ComputedTorqueConfig
FOLLOWS_JOINTS = True


def build(config: ComputedTorqueConfig, robot: Robot, joints: bool = False) -> tuple[Loop, ...]:
    """Make the one loop that a config describes; it commands every joint. See FollowsJoints.

    Raises:
        ConfigError: see ComputedTorque.
    """
    law = ComputedTorque(robot.model, config, robot.home, joints)
    return (Loop("whole", slice(0, robot.model.nq), config.period, law, follows_joints=joints),)


def start_posture(config: ComputedTorqueConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return where the arm stands at a trajectory's start: for a pose, with home's orientation."""
    return task_start(config.task, robot, start)
