"""Tip task of operational-space control: commanded acceleration for a position or a pose."""

from typing import Literal, NamedTuple, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.torque_law import Tip, second_order
from runner.robots.inverse_kinematics import solve_tip_pose
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.robots.task_space import task_basis
from runner.symbolic.maths import Array, Backend, Scalar

TaskName = Literal["position", "pose"]


class TipTaskConfig(Protocol):
    """Config of the tip motion of a law."""

    natural_frequency: float
    damping_ratio: float
    feedforward: bool
    singularity_damping: float


class TipParameters(NamedTuple):
    """The parameters of a tip task."""

    k_p: Scalar  # omega_n^2, in 1/s^2
    k_v: Scalar  # 2 xi omega_n, in 1/s
    directions: Array  # directions of the task's rows, shape (rows, 3) or (rows, 6); see task_basis
    orientation: Array  # desired orientation in the base frame, shape (3, 3)
    max_acceleration: Scalar  # largest k_p |x_d - x|, in m/s^2
    damping: Scalar  # singularity_damping^2
    singular_below: Scalar  # square of the singular value below which inverses are damped, in m^2
    lengths: Array  # length equivalent to a unit of each row, shape (rows,): 1 or, for a rotation, the reach in m


class TipTask:
    r"""Linear control of the tip: the commanded acceleration, eq. (3.40) of the thesis.

    .. math:: F^* = \ddot x_d + k_v (\dot x_d - \dot x) + k_p (x_d - x)

    Without feedforward the desired velocity and acceleration are zero, which is the goal law, eq. (3.33). With a
    maximum tip speed V it is Khatib's saturated form,

    .. math::

        F^* = \ddot x_d - k_v (\dot x - \dot x_d - \nu \frac{k_p}{k_v} (x_d - x)), \quad
        \nu = \min(1, V k_v / (k_p |x_d - x|))

    A pose has three more rows for an orientation R_0, with the error as a rotation vector in the base frame:

    .. math:: F^*_\omega = -k_v \omega + k_p \log(R_0 R^T)

    About a single axis this is the same linear law. An error of half a turn has no unique axis.

    If the tip can move or rotate only in some directions, as that of a planar arm, the task has only these rows; see
    task_basis.

    Args:
        model: The arm.
        orientation: R_0 in the base frame, shape (3, 3); None for position control.
        law: Config with omega_n, where k_p = omega_n^2 (3.37); xi, where k_v = 2 xi omega_n (3.38); the feedforward;
            and the damping of inverses near a singular configuration, as a fraction of the tip error.
        max_speed: V in m/s; None for no limit.
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
        """Dimensions of the task: 3 or 6 if the arm can move its tip in every direction."""
        moves = int(np.count_nonzero(directions[:, :3].any(axis=1)))  # the other rows are rotations
        self._moves, self._turns = moves, orientation is not None
        self._whole = self.rows == directions.shape[1]
        self._feedforward, self._bounded = law.feedforward, max_speed is not None
        self._damped = law.singularity_damping > 0.0
        k_p, k_v = second_order(law.natural_frequency, law.damping_ratio)
        # A rotation counts as the displacement of a point at the distance of the reach, so all rows are lengths.
        lengths = np.array(moves * [1.0] + (self.rows - moves) * [model.reach])
        self.parameters = TipParameters(
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
            ConfigError: if it has fewer than the tip has directions of motion, or the tip cannot move.
        """
        if not 0 < self.rows <= model.nq:
            raise ConfigError(
                f"controller.kind: needs {self.rows or 1} joints or more to bring the tip anywhere; the arm "
                f"has {model.nq} ({', '.join(model.joint_names)})"
            )

    def jacobian(self, parameters: TipParameters, tip: Tip) -> tuple[Array, Array]:
        """Return the task's Jacobian J in the base frame, shape (rows, nq), and dJ/dt dq, shape (rows,)."""
        J, dJ_dq = tip.J, tip.dJ_dq
        if not self._turns:
            J, dJ_dq = J[:3], dJ_dq[:3]
        return (J, dJ_dq) if self._whole else (parameters.directions.dot(J), parameters.directions.dot(dJ_dq))

    def error(self, backend: Backend, parameters: TipParameters, tip: Tip, reference: Array) -> Array:
        """Return desired less actual position and orientation, shape (rows,), in m and rad."""
        error: Array = reference[0] - tip.x
        if self._turns:
            error = np.concatenate([error, backend.rotation_vector(parameters.orientation.dot(tip.R.T))])
        return error if self._whole else np.asarray(parameters.directions.dot(error))

    def acceleration(
        self, backend: Backend, parameters: TipParameters, error: Array, velocity: Array, reference: Array
    ) -> Array:
        """Return F*, shape (rows,), in m/s^2 and rad/s^2, from the task's error and velocity."""
        approach: Array = parameters.k_p * error
        if self._bounded:
            approach = self._bound(backend, parameters, approach)
        if not self._feedforward:
            return np.asarray(approach - parameters.k_v * velocity)
        desired = reference[1:] if not self._turns else np.pad(reference[1:], ((0, 0), (0, 3)))
        if not self._whole:
            desired = desired.dot(parameters.directions.T)
        return np.asarray(desired[1] + parameters.k_v * (desired[0] - velocity) + approach)

    def _bound(self, backend: Backend, parameters: TipParameters, approach: Array) -> Array:
        way = approach[: self._moves]
        norm = backend.sqrt(way.dot(way))
        return backend.choose(
            backend.less(parameters.max_acceleration, norm),
            lambda: np.concatenate([way * (parameters.max_acceleration / norm), approach[self._moves :]]),
            lambda: approach,
        )

    def damp(self, backend: Backend, parameters: TipParameters, J: Array, error: Array, mobility: Array) -> Array:
        r"""Return J A J^T, shape (rows, rows), with damping on its diagonal.

        With rows in units of length the damping is lambda^2 = (singularity_damping |e|)^2, times the ratio of the
        traces of J A J^T and J J^T. It fades in as the smallest singular value falls below a tenth of the reach. It
        vanishes with the error, so it does not change rest or close tracking.

        Args:
            backend: Functions over the scalars of these arrays.
            parameters: Parameters of the task.
            J: Jacobian of the task, shape (rows, nq).
            error: Error of the task, shape (rows,).
            mobility: J A J^T, shape (rows, rows).
        """
        if not self._damped:
            return mobility
        J, error = parameters.lengths[:, None] * J, parameters.lengths * error
        square = J.dot(J.T)

        def damped() -> Array:
            nearness = backend.absolute(backend.smallest_eigenvalue(square)) / parameters.singular_below  # squared
            size = np.diagonal(mobility).dot(parameters.lengths**2)
            scale = size / backend.maximum(np.trace(square), 1e-300)
            amount = scale * parameters.damping * error.dot(error) * (1.0 - nearness)
            return np.asarray(mobility + np.diag(amount / parameters.lengths**2))

        far = backend.positive_definite(square - parameters.singular_below * np.eye(self.rows))
        return backend.choose(far, lambda: mobility, damped)


def held_orientation(task: TaskName, model: RobotModel, home: FloatArray) -> FloatArray | None:
    """Return the desired orientation of a task: that of home for a pose, None for a position.

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
    """Return joint positions for a pose with the orientation of home and the tip at `start`; None for a position task.

    Args:
        task: The task.
        robot: The robot.
        start: Start position of the tip, shape (3,), in m.
    """
    if task == "position":
        return None
    pose = robot.model.tip_pose(robot.home)
    pose[:3, 3] = start
    return solve_tip_pose(robot.model, pose, robot.home)
