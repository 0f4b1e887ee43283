"""Desired joint motion of joint-space controllers, direct or resolved from the tip motion."""

from typing import Any, NamedTuple, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.operational_space.tip_task import TaskName, TipNumbers, TipTask, TipTaskConfig, held_orientation
from runner.controllers.operational_space.whole_body_posture import PostureNumbers, PostureTask, posture_pd
from runner.controllers.torque_law import Arm, structure_of
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Scalar


class JointMotionConfig(TipTaskConfig, Protocol):
    """Config of the motion of a joint-space law; see JointLawConfig."""

    task: TaskName
    period: float
    null_space_frequency: float


class JointMotionNumbers(NamedTuple):
    """The numbers of a joint motion.

    Attributes:
        tip: Numbers of the tip task of the virtual arm.
        posture: Numbers of its posture task.
        period: Time between two ticks, in s.
    """

    tip: TipNumbers
    posture: PostureNumbers
    period: Scalar


class DesiredJoints(NamedTuple):
    """The desired state of the joints at a tick.

    Attributes:
        q: Positions, shape (nq,), in rad.
        dq: Velocities, shape (nq,), in rad/s.
        ddq: Accelerations, shape (nq,), in rad/s^2.
    """

    q: Array
    dq: Array
    ddq: Array


class JointMotion:
    r"""Desired joint positions, velocities and accelerations at each tick.

    A desired joint motion is used directly, without feedforward only its positions. A desired tip motion is the motion
    of a virtual arm whose tip obeys F* of TipTask (resolved acceleration; Luh, Walker and Paul, IEEE Transactions on
    Automatic Control 25(3), 1980):

    .. math::

        \ddot q_d = \ddot q_0 + J^+ (F^* - \dot J \dot q_d - J \ddot q_0), \qquad
        \ddot q_0 = -2 \omega_{n0} \dot q_d - \omega_{n0}^2 (q_d - q_\mathrm{rest})

    J, dJ/dt and F* are taken at q_d, which starts at the measured positions of the first tick. The acceleration is
    constant over each period. The virtual arm has no inertia, limits or noise, so disturbances of the real arm do not
    change q_d. Near a singular configuration the inverse is damped as in the tip laws: J^T (J J^T + lambda^2)^-1.

    Args:
        model: The arm.
        config: Config of the law.
        rest: Configuration of the posture task, shape (nq,), in rad.
        joints: True if the desired motion is a joint motion.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: JointMotionConfig, rest: FloatArray, joints: bool) -> None:
        self._joints, self._feedforward = joints, config.feedforward
        self._task = TipTask(model, held_orientation(config.task, model, rest), config)
        posture = PostureTask(config.null_space_frequency, rest).numbers
        self.numbers = JointMotionNumbers(self._task.numbers, posture, config.period)

    def structure(self) -> dict[str, Any]:
        """Return the attributes without the numbers; see TorqueLaw.structure."""
        return structure_of(self)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the memory at the first tick: q_d and dq_d, shape (2 nq,); empty for a joint motion."""
        return np.zeros(0) if self._joints else np.concatenate([q, np.zeros(len(q))])

    def follow(
        self, arm: Arm, numbers: JointMotionNumbers, reference: Array, memory: Array
    ) -> tuple[DesiredJoints, Array]:
        """Return the desired joints and the memory for the next tick."""
        if self._joints:
            q_d, dq_d, ddq_d = reference[0], reference[1], reference[2]
            if self._feedforward:
                return DesiredJoints(q_d, dq_d, ddq_d), memory
            return DesiredJoints(q_d, 0.0 * dq_d, 0.0 * ddq_d), memory
        h, n = numbers.period, len(memory) // 2
        q_d, dq_d = memory[:n], memory[n:]
        ddq_d = self._resolved_acceleration(arm, numbers, q_d, dq_d, reference)
        goes_on = np.concatenate([q_d + h * dq_d + 0.5 * h**2 * ddq_d, dq_d + h * ddq_d])
        return DesiredJoints(q_d, dq_d, ddq_d), goes_on

    def _resolved_acceleration(
        self, arm: Arm, numbers: JointMotionNumbers, q_d: Array, dq_d: Array, reference: Array
    ) -> Array:
        backend, task, tip = arm.backend, self._task, arm.tip(q_d, dq_d)
        J, dJ_dq = task.jacobian(numbers.tip, tip)
        error = task.error(backend, numbers.tip, tip, reference)
        ddq_0 = posture_pd(numbers.posture, q_d, dq_d)
        F = task.acceleration(backend, numbers.tip, error, J.dot(dq_d), reference) - dJ_dq - J.dot(ddq_0)
        square = task.damp(backend, numbers.tip, J, error, J.dot(J.T))
        return np.asarray(ddq_0 + J.T.dot(backend.solve_symmetric(square, F, "the tip's Jacobian is singular")))
