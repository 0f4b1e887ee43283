"""Computed-torque control: joints follow a joint motion that is resolved from the tip's."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.controllers.controller import FloatArray, Loop
from runner.controllers.maths import Array, Scalar
from runner.controllers.tip_task import TaskName, TipNumbers, TipTask, held_orientation, task_start
from runner.controllers.torque_law import Arm, TorqueLaw
from runner.controllers.whole_body_posture import HeldPosture, PostureNumbers, drawn_to
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
        tip: Of the task that leads the imagined arm's tip.
        posture: Of its null space.
        k_p: omega_n^2, in 1/s^2.
        k_v: 2 xi omega_n, in 1/s.
        k_i: Of the integral, in 1/s^3.
        period: Time between two ticks, in s.
    """

    tip: TipNumbers
    posture: PostureNumbers
    k_p: Scalar
    k_v: Scalar
    k_i: Scalar
    period: Scalar


class ComputedTorque(TorqueLaw[ComputedTorqueNumbers]):
    r"""Inverse dynamics in joint space (Luh, Walker and Paul, IEEE Transactions on Automatic Control 25(3), 1980).

    .. math:: \tau = M (\ddot q_d + 2 \xi \omega_n (\dot q_d - \dot q) + \omega_n^2 (q_d - q) + k_i z) + V + G

    Under an exact model each joint's error obeys eq. (3.36) of the thesis, whatever the posture and speed. The integral
    z of q_d - q, tick by tick, takes away what a wrong model or a constant load leaves at rest; the closed loop is
    stable for k_i < 2 xi omega_n^3, and winds up while a torque is at its limit. Without it k_i is 0. The joint
    motion q_d is that of an imagined arm, whose tip obeys F* of TipTask (resolved acceleration):

    .. math::

        \ddot q_d = \ddot q_0 + J^+ (F^* - \dot J \dot q_d - J \ddot q_0), \qquad
        \ddot q_0 = -2 \omega_{n0} \dot q_d - \omega_{n0}^2 (q_d - q_\mathrm{rest})

    J, dJ/dt and F* are taken at q_d. It stands where the encoders find the arm at the first tick, and each tick goes on
    by an acceleration that is constant for a period. The imagined arm has no inertia, no limits and no noise: what
    disturbs the arm moves its tip against q_d, and never q_d.

    Near a singular posture the inverse is damped as in the other tip laws: J^T (J J^T + lambda^2)^-1.

    Where the desired motion is one of the joints, q_d and its derivatives are that motion, and nothing is resolved;
    without feedforward the law sees the posture q_d at rest.

    Args:
        model: The arm.
        config: The law's numbers.
        rest: Posture of the null space, shape (nq,), in rad.
        joints: Whether the desired motion is one of the joints.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: ComputedTorqueConfig, rest: FloatArray, joints: bool = False) -> None:
        self._joints, self._feedforward = joints, config.feedforward
        self._task = TipTask(
            model,
            held_orientation(config.task, model, rest),
            config.natural_frequency,
            config.damping_ratio,
            config.feedforward,
            None,
            config.singularity_damping,
        )
        self._integrates = config.integral_gain > 0.0
        numbers = ComputedTorqueNumbers(
            tip=self._task.numbers,
            posture=HeldPosture(config.null_space_frequency, rest).numbers,
            k_p=config.natural_frequency**2,
            k_v=2.0 * config.damping_ratio * config.natural_frequency,
            k_i=config.integral_gain,
            period=config.period,
        )
        super().__init__([model], config.gravity_compensation, numbers)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the joint motion where it starts, at rest, and no integral: q_d, dq_d/dt and z, shape (3 nq,).

        Of a law that follows joints, z alone, shape (nq,).
        """
        if self._joints:
            return np.zeros(len(q))
        return np.concatenate([q, np.zeros(2 * len(q))])

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
        (arm,), h, n = arms, numbers.period, len(q)
        if self._joints:
            return self._follow_joints(arm, numbers, q, dq, reference, memory)
        q_d, dq_d, z = memory[:n], memory[n : 2 * n], memory[2 * n :]
        ddq_d = self._resolved_acceleration(arm, numbers, q_d, dq_d, reference)
        error = q_d - q
        ddq = ddq_d + numbers.k_v * (dq_d - dq) + numbers.k_p * error
        if self._integrates:
            ddq, z = ddq + numbers.k_i * z, z + h * error
        goes_on = np.concatenate([q_d + h * dq_d + 0.5 * h**2 * ddq_d, dq_d + h * ddq_d, z])
        return arm.inverse_dynamics(q, dq, ddq), goes_on

    def _follow_joints(
        self, arm: Arm, numbers: ComputedTorqueNumbers, q: Array, dq: Array, reference: Array, z: Array
    ) -> tuple[Array, Array]:
        """Return the torques towards a joint motion, and the integral for the next tick."""
        error = reference[0] - q
        led = (reference[1] - dq, reference[2]) if self._feedforward else (-dq, 0.0 * q)
        ddq = led[1] + numbers.k_v * led[0] + numbers.k_p * error
        if self._integrates:
            ddq, z = ddq + numbers.k_i * z, z + numbers.period * error
        return arm.inverse_dynamics(q, dq, ddq), z

    def _resolved_acceleration(
        self, arm: Arm, numbers: ComputedTorqueNumbers, q_d: Array, dq_d: Array, reference: Array
    ) -> Array:
        maths, task, tip = arm.maths, self._task, arm.tip(q_d, dq_d)
        J, dJ_dq = task.jacobian(numbers.tip, tip)
        error = task.error(maths, numbers.tip, tip, reference)
        ddq_0 = drawn_to(numbers.posture, q_d, dq_d)
        F = task.acceleration(maths, numbers.tip, error, J.dot(dq_d), reference) - dJ_dq - J.dot(ddq_0)
        square = task.damp(maths, numbers.tip, J, error, J.dot(J.T))
        return np.asarray(ddq_0 + J.T.dot(maths.solve_symmetric(square, F, "the tip's Jacobian is singular")))


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
