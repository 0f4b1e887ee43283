"""What the tip is to do: its position led, or its pose; the same for every law that asks it for an acceleration."""

from typing import Literal

import numpy as np
import pinocchio as pin

from runner.controllers.controller import FloatArray
from runner.errors import ConfigError
from runner.robots.inverse_kinematics import solve_tip_pose
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.robots.task_space import task_directions

TaskName = Literal["position", "pose"]


class TipTask:
    r"""Linear control of the tip: the acceleration that it is asked for, eq. (3.40) of the thesis.

    .. math:: F^* = \ddot x_d + k_v (\dot x_d - \dot x) + k_p (x_d - x)

    Without feedforward the desired velocity and acceleration are taken as zero, which is the goal law, eq. (3.33).
    With a largest tip speed V it is Khatib's saturated form,

    .. math::

        F^* = \ddot x_d - k_v (\dot x - \dot x_d - \nu \frac{k_p}{k_v} (x_d - x)), \quad
        \nu = \min(1, V k_v / (k_p |x_d - x|))

    A pose has three rows more. They hold an orientation R_0, with the error as a rotation vector in the base frame:

    .. math:: F^*_\omega = -k_v \omega + k_p \log(R_0 R^T)

    About any one axis this is the same linear law. An error of half a turn has no unique axis.

    Where an arm can move or turn its tip in some directions only, as a planar one, the task has these alone for its
    rows; see task_directions.

    Args:
        model: The arm.
        pin_model: Its Pinocchio model, as the law that asks has it.
        data: The data of that model; `update` renews them.
        orientation: R_0 in the base frame, shape (3, 3); None leads the position alone.
        natural_frequency: omega_n in rad/s; k_p = omega_n^2 (3.37).
        damping_ratio: xi; k_v = 2 xi omega_n (3.38).
        feedforward: Whether the desired derivatives are part of F*.
        max_speed: V in m/s; None is no limit.
        singularity_damping: Share of the tip's error by which inverses are damped near a singular posture.
    """

    def __init__(
        self,
        model: RobotModel,
        pin_model: pin.Model,
        data: pin.Data,
        orientation: FloatArray | None,
        natural_frequency: float,
        damping_ratio: float,
        feedforward: bool,
        max_speed: float | None,
        singularity_damping: float,
    ) -> None:
        directions = task_directions(model, orientation is not None)
        self.rows = len(directions)
        """Dimensions of the task: 3 or 6 of an arm that can move its tip in every direction."""
        self._directions = None if self.rows == directions.shape[1] else directions
        self._model, self._data = pin_model, data
        self._tip = model.tip_frame
        # Views into Pinocchio's data: each update of the frame refreshes them, without a new object per tick.
        self._x: FloatArray = data.oMf[self._tip].translation
        self._R: FloatArray = data.oMf[self._tip].rotation
        self._orientation = orientation
        self._zero = np.zeros(model.nq)
        self._k_p = natural_frequency**2
        self._k_v = 2.0 * damping_ratio * natural_frequency
        self._feedforward = feedforward
        self._max_speed = max_speed
        self._damping = singularity_damping
        self._singular_below = 0.1 * model.reach
        # A turn counts as the way that it moves a point a reach away, so that all rows are lengths.
        self._moves = int(np.count_nonzero(directions[:, :3].any(axis=1)))  # the other rows turn
        self._lengths = np.array(self._moves * [1.0] + (self.rows - self._moves) * [model.reach])

    def update(self, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Take joint positions and velocities, shapes (nq,).

        Returns:
            The task's Jacobian J in the base frame, shape (rows, nq), and dJ/dt dq, shape (rows,).
        """
        model, data = self._model, self._data
        pin.forwardKinematics(model, data, q, dq, self._zero)
        pin.computeJointJacobians(model, data)
        pin.updateFramePlacement(model, data, self._tip)
        J: FloatArray = pin.getFrameJacobian(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED)
        motion = pin.getFrameClassicalAcceleration(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED)
        dJ_dq = motion.vector
        if self._orientation is None:
            J, dJ_dq = J[:3], motion.linear
        return (J, dJ_dq) if self._directions is None else (self._directions.dot(J), self._directions.dot(dJ_dq))

    def error(self, reference: FloatArray) -> FloatArray:
        """Return desired less actual since the last update, shape (rows,), in m and rad."""
        error: FloatArray = reference[0] - self._x
        if self._orientation is not None:
            error = np.concatenate([error, pin.log3(self._orientation @ self._R.T)])
        return error if self._directions is None else self._directions.dot(error)

    def acceleration(self, error: FloatArray, velocity: FloatArray, reference: FloatArray) -> FloatArray:
        """Return F*, shape (rows,), in m/s^2 and rad/s^2, from the task's error and velocity."""
        approach = self._k_p * error
        if self._max_speed is not None:
            largest = self._k_v * self._max_speed
            way = approach[: self._moves]
            norm = float(np.sqrt(way.dot(way)))
            if norm > largest:
                way *= largest / norm
        if not self._feedforward:
            return np.asarray(approach - self._k_v * velocity)
        desired = reference[1:] if self._orientation is None else np.pad(reference[1:], ((0, 0), (0, 3)))
        if self._directions is not None:
            desired = desired.dot(self._directions.T)
        return np.asarray(desired[1] + self._k_v * (desired[0] - velocity) + approach)

    def damping(self, J: FloatArray, error: FloatArray, mobility: FloatArray) -> FloatArray | None:
        r"""Return what to add to the diagonal of J A J^T before it is inverted, shape (rows,); None where nothing.

        With rows in units of length it is lambda^2 = (singularity_damping |e|)^2, times how large J A J^T is to J J^T.
        It fades in as the smallest singular value falls below a tenth of the reach, and vanishes with the error, so
        that neither rest nor close tracking is touched.

        Args:
            J: The task's Jacobian, shape (rows, nq).
            error: The task's error, shape (rows,).
            mobility: J A J^T, shape (rows, rows).
        """
        if not self._damping:
            return None
        J, error = self._lengths[:, None] * J, self._lengths * error
        smallest = float(np.sqrt(abs(np.linalg.eigvalsh(J.dot(J.T))[0])))
        if smallest >= self._singular_below:
            return None
        nearness = smallest / self._singular_below
        size = float(np.diagonal(mobility).dot(self._lengths**2))
        scale = size / max(float(np.vdot(J, J)), 1e-300)
        amount: float = scale * self._damping**2 * error.dot(error) * (1.0 - nearness**2)
        return amount / self._lengths**2


def held_orientation(task: TaskName, model: RobotModel, home: FloatArray) -> FloatArray | None:
    """Return the orientation that a task holds: home's for a pose, None for a position.

    Raises:
        ConfigError: if the task has more dimensions than the arm has joints.
    """
    rows, least = (len(task_directions(model, pose)) for pose in (task == "pose", False))
    if model.nq < rows or not least:
        raise ConfigError(
            [
                f"controller.task: {task} has {rows} dimensions, and the arm {model.nq} joints "
                f"({', '.join(model.joint_names)}); "
                + (
                    "take controller.task=position"
                    if 0 < least <= model.nq
                    else f"it needs {least or 1} joints or more"
                )
            ]
        )
    return None if task == "position" else model.tip_pose(home)[:3, :3]


def task_start(task: TaskName, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return joint positions that start a task with the tip at a place, shape (3,); None leaves it to the position."""
    if task == "position":
        return None
    pose = robot.model.tip_pose(robot.home)
    pose[:3, 3] = start
    return solve_tip_pose(robot.model, pose, robot.home)
