"""Tip task of operational-space control: commanded acceleration for a position or a pose."""

from typing import Literal, NamedTuple, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.torque_law import Tip
from runner.robots.inverse_kinematics import solve_tip_pose
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.robots.task_space import task_basis
from runner.symbolic.maths import Array, Backend, Scalar

TaskName = Literal["position", "pose"]


class TipTaskConfig(Protocol):
    """What the config of a law says of the motion of the tip."""

    natural_frequency: float
    damping_ratio: float
    feedforward: bool
    singularity_damping: float


class TipNumbers(NamedTuple):
    """The numbers of a tip task.

    Attributes:
        k_p: omega_n^2, in 1/s^2.
        k_v: 2 xi omega_n, in 1/s.
        directions: What the task has for its rows, shape (rows, 3) or (rows, 6); see task_basis.
        orientation: The orientation held, in the base frame, shape (3, 3).
        max_acceleration: Largest k_p |x_d - x|, in m/s^2.
        damping: Square of the share of the tip's error by which inverses are damped.
        singular_below: Square of the singular value below which they are, in m^2.
        lengths: Length that a unit of each row counts as, shape (rows,).
    """

    k_p: Scalar
    k_v: Scalar
    directions: Array
    orientation: Array
    max_acceleration: Scalar
    damping: Scalar
    singular_below: Scalar
    lengths: Array


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
    rows; see task_basis.

    Args:
        model: The arm.
        orientation: R_0 in the base frame, shape (3, 3); None leads the position alone.
        law: omega_n, with k_p = omega_n^2 (3.37); xi, with k_v = 2 xi omega_n (3.38); whether the desired derivatives
            are part of F*; and the share of the tip's error by which inverses are damped near a singular posture.
        max_speed: V in m/s; None is no limit.
    """

    def __init__(
        self,
        model: RobotModel,
        orientation: FloatArray | None,
        law: TipTaskConfig,
        max_speed: float | None = None,
    ) -> None:
        directions = task_basis(model, orientation is not None)
        self.rows = len(directions)
        """Dimensions of the task: 3 or 6 of an arm that can move its tip in every direction."""
        moves = int(np.count_nonzero(directions[:, :3].any(axis=1)))  # the other rows turn
        self._moves, self._turns = moves, orientation is not None
        self._whole = self.rows == directions.shape[1]
        self._feedforward, self._bounded = law.feedforward, max_speed is not None
        self._damped = law.singularity_damping > 0.0
        k_p, k_v = law.natural_frequency**2, 2.0 * law.damping_ratio * law.natural_frequency
        # A turn counts as the way that it moves a point a reach away, so that all rows are lengths.
        lengths = np.array(moves * [1.0] + (self.rows - moves) * [model.reach])
        self.numbers = TipNumbers(
            k_p=k_p,
            k_v=k_v,
            directions=directions,
            orientation=np.eye(3) if orientation is None else orientation,
            max_acceleration=k_v * max_speed if max_speed is not None else 0.0,
            damping=law.singularity_damping**2,
            singular_below=(0.1 * model.reach) ** 2,
            lengths=lengths,
        )

    def check_joints(self, model: RobotModel) -> None:
        """Check that an arm has enough joints for the task.

        Raises:
            ConfigError: if it has fewer than the tip has directions to go.
        """
        if not 0 < self.rows <= model.nq:
            raise ConfigError(
                f"controller.kind: needs {self.rows or 1} joints or more to bring the tip anywhere; the arm "
                f"has {model.nq} ({', '.join(model.joint_names)})"
            )

    def jacobian(self, numbers: TipNumbers, tip: Tip) -> tuple[Array, Array]:
        """Return the task's Jacobian J in the base frame, shape (rows, nq), and dJ/dt dq, shape (rows,)."""
        J, dJ_dq = tip.J, tip.dJ_dq
        if not self._turns:
            J, dJ_dq = J[:3], dJ_dq[:3]
        return (J, dJ_dq) if self._whole else (numbers.directions.dot(J), numbers.directions.dot(dJ_dq))

    def error(self, backend: Backend, numbers: TipNumbers, tip: Tip, reference: Array) -> Array:
        """Return desired less actual, shape (rows,), in m and rad."""
        error: Array = reference[0] - tip.x
        if self._turns:
            error = np.concatenate([error, backend.rotation_vector(numbers.orientation.dot(tip.R.T))])
        return error if self._whole else np.asarray(numbers.directions.dot(error))

    def acceleration(
        self, backend: Backend, numbers: TipNumbers, error: Array, velocity: Array, reference: Array
    ) -> Array:
        """Return F*, shape (rows,), in m/s^2 and rad/s^2, from the task's error and velocity."""
        approach: Array = numbers.k_p * error
        if self._bounded:
            approach = self._bound(backend, numbers, approach)
        if not self._feedforward:
            return np.asarray(approach - numbers.k_v * velocity)
        desired = reference[1:] if not self._turns else np.pad(reference[1:], ((0, 0), (0, 3)))
        if not self._whole:
            desired = desired.dot(numbers.directions.T)
        return np.asarray(desired[1] + numbers.k_v * (desired[0] - velocity) + approach)

    def _bound(self, backend: Backend, numbers: TipNumbers, approach: Array) -> Array:
        way = approach[: self._moves]
        norm = backend.sqrt(way.dot(way))
        return backend.choose(
            backend.less(numbers.max_acceleration, norm),
            lambda: np.concatenate([way * (numbers.max_acceleration / norm), approach[self._moves :]]),
            lambda: approach,
        )

    def damp(self, backend: Backend, numbers: TipNumbers, J: Array, error: Array, mobility: Array) -> Array:
        r"""Return J A J^T, shape (rows, rows), with what is added to its diagonal before it is inverted.

        With rows in units of length that is lambda^2 = (singularity_damping |e|)^2, times how large J A J^T is to
        J J^T. It fades in as the smallest singular value falls below a tenth of the reach, and vanishes with the error,
        so that neither rest nor close tracking is touched.

        Args:
            backend: The functions over the scalars of these arrays.
            numbers: The task's numbers.
            J: The task's Jacobian, shape (rows, nq).
            error: The task's error, shape (rows,).
            mobility: J A J^T, shape (rows, rows).
        """
        if not self._damped:
            return mobility
        J, error = numbers.lengths[:, None] * J, numbers.lengths * error
        square = J.dot(J.T)

        def damped() -> Array:
            nearness = backend.absolute(backend.smallest_eigenvalue(square)) / numbers.singular_below  # squared
            size = np.diagonal(mobility).dot(numbers.lengths**2)
            scale = size / backend.maximum(np.trace(square), 1e-300)
            amount = scale * numbers.damping * error.dot(error) * (1.0 - nearness)
            return np.asarray(mobility + np.diag(amount / numbers.lengths**2))

        far = backend.positive_definite(square - numbers.singular_below * np.eye(self.rows))
        return backend.choose(far, lambda: mobility, damped)


def held_orientation(task: TaskName, model: RobotModel, home: FloatArray) -> FloatArray | None:
    """Return the orientation that a task holds: home's for a pose, None for a position.

    Raises:
        ConfigError: if the task has more dimensions than the arm has joints.
    """
    rows, least = (len(task_basis(model, pose)) for pose in (task == "pose", False))
    if model.nq < rows or not least:
        raise ConfigError(
            f"controller.task: {task} has {rows} dimensions, and the arm {model.nq} joints "
            f"({', '.join(model.joint_names)}); "
            + ("take controller.task=position" if 0 < least <= model.nq else f"it needs {least or 1} joints or more")
        )
    return None if task == "position" else model.tip_pose(home)[:3, :3]


def task_start(task: TaskName, robot: Robot, start: FloatArray) -> FloatArray | None:
    """Return joint positions that start a task with the tip at a place, shape (3,); None leaves it to the position."""
    if task == "position":
        return None
    pose = robot.model.tip_pose(robot.home)
    pose[:3, 3] = start
    return solve_tip_pose(robot.model, pose, robot.home)
