"""Passivity-based control of the joints, without adaptation."""

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


class PassivityConfig(StrictModel):
    """Config of passivity-based control of the joints.

    Attributes:
        kind: Its name in the registry.
        task: Whether the tip's position is led, or its pose, with home's orientation held.
        natural_frequency: lambda, and K_D / diag M, and omega_n of the motion that leads the tip, in rad/s.
        damping_ratio: xi of the motion that leads the tip; the joints have two equal poles.
        period: Time between two ticks, in s.
        gravity_compensation: Whether the law holds the gravity term.
        feedforward: Whether the law follows the desired velocity and acceleration, or sees a moving goal.
        singularity_damping: Share of the tip's error by which the inverse of J is damped near a singular posture;
            0 is the law without damping.
        null_space_frequency: omega_n of the posture task, home, of an arm with more joints than the task needs, in
            rad/s.
    """

    kind: Literal["passivity"]
    task: TaskName
    natural_frequency: PositiveFloat
    damping_ratio: PositiveFloat
    period: PositiveFloat
    gravity_compensation: bool
    feedforward: bool
    singularity_damping: NonNegativeFloat
    null_space_frequency: NonNegativeFloat


class PassivityNumbers(NamedTuple):
    """The numbers of passivity-based control.

    Attributes:
        motion: Of the joint motion that is followed.
        rate: lambda, in 1/s.
        damping: Diagonal of K_D, shape (nq,), in kg m^2/s.
    """

    motion: JointMotionNumbers
    rate: Scalar
    damping: Array


class Passivity(TorqueLaw[PassivityNumbers]):
    r"""Passivity-based control (Slotine and Li, International Journal of Robotics Research 6(3), 1987), not adaptive.

    .. math::

        \tau = M \ddot q_r + C \dot q_r + G + K_D s, \qquad \dot q_r = \dot q_d + \lambda (q_d - q), \qquad
        s = \dot q_r - \dot q

    with lambda = omega_n and K_D = omega_n diag M(home). Under an exact model M ds/dt + (C + K_D) s = 0, so that
    s^T M s / 2 falls as -s^T K_D s: it cancels no dynamics of the arm, and is stable for any K_D > 0 in continuous
    time. At rest a wrong gravity term leaves the sag (G - G_believed) / (lambda K_D), which is that of PD control.

    Args:
        model: The arm.
        config: The law's numbers.
        rest: Home: posture of the null space and of K_D, shape (nq,), in rad.
        joints: Whether the desired motion is one of the joints; see JointMotion.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: PassivityConfig, rest: FloatArray, joints: bool = False) -> None:
        self._motion = JointMotion(model, config, rest, joints)
        numbers = PassivityNumbers(
            motion=self._motion.numbers,
            rate=config.natural_frequency,
            damping=config.natural_frequency * model.mass_matrix(rest).diagonal(),
        )
        super().__init__([model], config.gravity_compensation, numbers)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the joint motion where it starts; see JointMotion."""
        return self._motion.start(q)

    def evaluate(
        self,
        arms: Sequence[Arm],
        numbers: PassivityNumbers,
        time: Scalar,
        q: Array,
        dq: Array,
        reference: Array,
        memory: Array,
    ) -> tuple[Array, Array]:
        """Return the torques of the law above, and the joint motion at the next tick; see TorqueLaw."""
        (arm,) = arms
        (q_d, dq_d, ddq_d), goes_on = self._motion.follow(arm, numbers.motion, reference, memory)
        dq_r, ddq_r = dq_d + numbers.rate * (q_d - q), ddq_d + numbers.rate * (dq_d - dq)
        rest = np.zeros(len(q))
        # V is quadratic in the velocities: C(q, v) v_r = (V(v + v_r) - V(v - v_r)) / 4, in which gravity cancels.
        torque = numbers.damping * (dq_r - dq) + 0.25 * arm.inverse_dynamics(q, dq + dq_r, rest)
        torque = torque - 0.25 * arm.inverse_dynamics(q, dq - dq_r, rest)
        return torque + arm.inverse_dynamics(q, rest, ddq_r), goes_on


CONFIG = PassivityConfig
FOLLOWS_JOINTS = True


def build(config: PassivityConfig, robot: Robot, joints: bool = False) -> tuple[Loop, ...]:
    """Make the one loop that a config describes; it commands every joint. See FollowsJoints.

    Raises:
        ConfigError: see Passivity.
    """
    law = Passivity(robot.model, config, robot.home, joints)
    return (Loop("whole", slice(0, robot.model.nq), config.period, law, follows_joints=joints),)


def start_posture(config: PassivityConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return where the arm stands at a trajectory's start: for a pose, with home's orientation."""
    return task_start(config.task, robot, start)
