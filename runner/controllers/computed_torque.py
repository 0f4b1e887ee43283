"""Computed-torque control: joints follow a joint motion that is resolved from the tip's."""

from typing import Literal

import numpy as np
import pinocchio as pin
from pydantic import NonNegativeFloat, PositiveFloat
from scipy.linalg.lapack import dposv

from runner.controllers.controller import FloatArray, Loop
from runner.controllers.tip_task import TaskName, TipTask, held_orientation, task_start
from runner.controllers.whole_body_posture import HeldPosture
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


class ComputedTorque:
    r"""Inverse dynamics in joint space (Luh, Walker and Paul, IEEE Transactions on Automatic Control 25(3), 1980).

    .. math:: \tau = M (\ddot q_d + 2 \xi \omega_n (\dot q_d - \dot q) + \omega_n^2 (q_d - q)) + V + G

    Under an exact model each joint's error obeys eq. (3.36) of the thesis, whatever the posture and speed. The joint
    motion q_d is that of an imagined arm, whose tip obeys F* of TipTask (resolved acceleration):

    .. math::

        \ddot q_d = \ddot q_0 + J^+ (F^* - \dot J \dot q_d - J \ddot q_0), \qquad
        \ddot q_0 = -2 \omega_{n0} \dot q_d - \omega_{n0}^2 (q_d - q_\mathrm{rest})

    J, dJ/dt and F* are taken at q_d. It stands where the encoders find the arm at the first tick, and each tick goes on
    by an acceleration that is constant for a period. The imagined arm has no inertia, no limits and no noise: what
    disturbs the arm moves its tip against q_d, and never q_d.

    Near a singular posture the inverse is damped as in the other tip laws: J^T (J J^T + lambda^2)^-1.

    Args:
        model: The arm.
        config: The law's numbers.
        rest: Posture of the null space, shape (nq,), in rad.

    Raises:
        ConfigError: if the arm has fewer joints than the task has dimensions.
    """

    def __init__(self, model: RobotModel, config: ComputedTorqueConfig, rest: FloatArray) -> None:
        self._model = pin.Model(model.pin_model)
        if not config.gravity_compensation:
            self._model.gravity.linear = np.zeros(3)
        self._data = self._model.createData()
        self._task = TipTask(
            model,
            self._model,
            self._data,
            held_orientation(config.task, model, rest),
            config.natural_frequency,
            config.damping_ratio,
            config.feedforward,
            None,
            config.singularity_damping,
        )
        self._k_p = config.natural_frequency**2
        self._k_v = 2.0 * config.damping_ratio * config.natural_frequency
        self._posture = HeldPosture(config.null_space_frequency, rest)
        self._period = config.period
        self._started = False
        self._q_d, self._dq_d = np.zeros(model.nq), np.zeros(model.nq)

    def reset(self) -> None:
        """Forget the joint motion; it starts anew where the next measurement finds the arm, at rest."""
        self._started = False

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the law above, and go on to the next tick; see Controller.torque."""
        if not self._started:
            self._started = True
            self._q_d, self._dq_d = q.copy(), np.zeros(len(q))
        q_d, dq_d, h = self._q_d, self._dq_d, self._period
        ddq_d = self._resolved_acceleration(q_d, dq_d, reference)
        ddq = ddq_d + self._k_v * (dq_d - dq) + self._k_p * (q_d - q)
        torque: FloatArray = pin.rnea(self._model, self._data, q, dq, ddq)
        self._q_d = q_d + h * dq_d + 0.5 * h**2 * ddq_d
        self._dq_d = dq_d + h * ddq_d
        return torque

    def _resolved_acceleration(self, q_d: FloatArray, dq_d: FloatArray, reference: FloatArray) -> FloatArray:
        J, dJ_dq = self._task.update(q_d, dq_d)
        error = self._task.error(reference)
        ddq_0 = self._posture.acceleration(q_d, dq_d)
        asked = self._task.acceleration(error, J.dot(dq_d), reference) - dJ_dq - J.dot(ddq_0)
        square = J.dot(J.T)
        added = self._task.damping(J, error, square)
        if added is not None:
            square[np.diag_indices_from(square)] += added
        _, solution, info = dposv(square, asked)
        if info:
            raise np.linalg.LinAlgError("the tip's Jacobian is singular")
        return np.asarray(ddq_0 + J.T.dot(solution))


CONFIG = ComputedTorqueConfig


def build(config: ComputedTorqueConfig, robot: Robot) -> tuple[Loop, ...]:
    """Make the one loop that a config describes; it commands every joint.

    Raises:
        ConfigError: see ComputedTorque.
    """
    return (Loop("whole", slice(0, robot.model.nq), config.period, ComputedTorque(robot.model, config, robot.home)),)


def start_posture(config: ComputedTorqueConfig, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return where the arm stands at a trajectory's start: for a pose, with home's orientation."""
    return task_start(config.task, robot, start)
