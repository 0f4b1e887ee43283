"""Resolved-rate control: weighted, damped and bounded joint velocities, with tasks in the null space."""

from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import eigen
from runner.base.portable import cross, dot, solve_symmetric
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, JointSpeed, PerSecond

_SINGULAR = "the tip's Jacobian is singular"


class NullSpaceConfig(StrictModel):
    """Config of the null-space task.

    Attributes:
        task: Objective: a configuration (posture), the middle of the joint ranges, the largest manipulability, or none,
            which gives the shortest joint motion.
        gain: Gain k of the task, in 1/s.
        posture: Desired configuration, in rad (m for a prismatic joint); None for home.
        max_speed: Maximum joint speed of the task, in rad/s (m/s for a prismatic joint); None for no limit.
    """

    task: Literal["none", "posture", "joint_limits", "manipulability"]
    gain: PerSecond[NonNegativeFloat]
    posture: JointPosition[list[float] | None]
    max_speed: JointSpeed[PositiveFloat | None]


class NullSpaceTask:
    r"""Joint velocities of a task, before their projection into the null space of the tip task.

    - posture: k (q_rest - q);
    - joint_limits: k (q_mid - q) / d^2 for each joint, with d half its range: descent of Liegeois' sum of squared
      distances from the middle (IEEE Transactions on Systems, Man and Cybernetics 7(12), 1977); 0 for unlimited joints;
    - manipulability: k times the gradient of ln w, with Yoshikawa's w = sqrt(det J J^T).

    Args:
        config: Config of the task.
        rest: Desired configuration, shape (nq,), in rad.
        position_limits: Lower and upper joint positions, shape (2, nq), in rad; infinite if there are none.
    """

    def __init__(self, config: NullSpaceConfig, rest: FloatArray, position_limits: FloatArray) -> None:
        self._task = config.task
        self._gain = config.gain
        self._rest = rest
        self._max_speed = config.max_speed
        bounded = np.isfinite(position_limits).all(axis=0)
        lower, upper = np.where(bounded, position_limits, [[-1.0], [1.0]])
        self._middle = 0.5 * (lower + upper)
        self._pull = np.where(bounded, 4.0 / (upper - lower) ** 2, 0.0)

    def velocity(self, q: FloatArray, J: FloatArray, directions: FloatArray) -> FloatArray:
        """Return the joint velocities of the task, shape (nq,), in rad/s.

        Args:
            q: Joint positions, shape (nq,), in rad.
            J: The tip's basic Jacobian in the base frame, shape (6, nq).
            directions: Directions of the tip task, shape (rows, 3) for the position, (rows, 6) for the pose; see
                task_basis.
        """
        if self._task == "none" or self._gain == 0.0:
            return np.zeros(len(q))
        if self._task == "posture":
            direction = self._rest - q
        elif self._task == "joint_limits":
            direction = self._pull * (self._middle - q)
        else:
            direction = log_manipulability_gradient(J, directions)
        velocity: FloatArray = self._gain * direction
        if self._max_speed is not None:
            fastest = float(np.abs(velocity).max())
            velocity *= self._max_speed / max(self._max_speed, fastest)
        return velocity


def log_manipulability_gradient(J: FloatArray, directions: FloatArray) -> FloatArray:
    r"""Return the gradient of ln w with respect to the joint positions, shape (nq,), in 1/rad.

    .. math:: \partial \ln w / \partial q_k = \mathrm{tr}(J^+ \, \partial J / \partial q_k)

    A joint moves the links after it. With j_i the linear and z_i the angular column of joint i (z_i = 0 for a prismatic
    joint),
    dj_i/dq_k = z_k x j_i and dz_i/dq_k = z_k x z_i for k <= i, dj_i/dq_k = z_i x j_k and dz_i/dq_k = 0 for k > i.

    Args:
        J: The tip's basic Jacobian in the base frame, shape (6, nq).
        directions: Task directions of w, shape (rows, 3) for the position, (rows, 6) for the pose.

    Raises:
        numpy.linalg.LinAlgError: at a singular configuration.
    """
    linear, angular = J[:3].T, J[3:].T
    first = np.minimum.outer(np.arange(len(linear)), np.arange(len(linear)))  # [k, i]: the one nearer to the base
    last = np.maximum.outer(np.arange(len(linear)), np.arange(len(linear)))
    dJ = cross(angular[first], linear[last])  # [k, i, row]
    if directions.shape[1] == 6:
        upstream = np.tril(np.ones((len(linear), len(linear)))).T[:, :, None]  # k <= i
        dJ = np.concatenate([dJ, upstream * cross(angular[first], angular[last])], axis=2)
    dJ = dJ @ directions.T
    task = directions @ J[: directions.shape[1]]
    inverse = solve_symmetric(task @ task.T, task)  # (J J^T)^-1 J, the transpose of J^+
    gradient: FloatArray = np.einsum("ri,kir->k", inverse, dJ)
    return gradient


class ResolvedRate:
    r"""Joint velocities for a tip velocity, closest to those of a null-space task.

    .. math::

        \dot q = \dot q_0 + W^{-1} J^T (J W^{-1} J^T + \lambda^2 1)^{-1} (v - J \dot q_0)

    With lambda = 0 and W = 1 this is J^+ v + (1 - J^+ J) q0', with J^+ = J^T (J J^T)^-1 of a wide Jacobian. lambda
    grows from zero as the smallest singular value sigma of J W^-1/2 falls below a threshold, lambda^2 = damping^2
    (1 - (sigma / damping)^2) (Nakamura and Hanafusa, Journal of Dynamic Systems, Measurement and Control 108, 1986).

    Joints that would leave their bounds are fixed at them, the worst first, and the others are solved again (saturation
    in the null space: Flacco, De Luca and Khatib, IEEE Transactions on Robotics 31(3), 2015). If the others cannot
    compensate, the velocities are clipped and v is not reached.

    Args:
        weights: Diagonal of W, shape (nq,): cost of the motion of each joint.
        damping: Threshold of the singular value, and largest lambda, in the unit of J; 0 for no damping.
    """

    def __init__(self, weights: FloatArray, damping: float) -> None:
        self._mobility = 1.0 / weights
        self._damping = damping

    def solve(self, J: FloatArray, v: FloatArray, dq0: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
        """Return joint velocities within their bounds, shape (nq,), in rad/s.

        Args:
            J: Jacobian of the tip's task, shape (m, nq).
            v: Velocity of the tip's task, shape (m,).
            dq0: Joint velocities of the null-space task, shape (nq,), in rad/s.
            lower: Smallest joint velocities, shape (nq,), in rad/s.
            upper: Largest joint velocities, shape (nq,), in rad/s.

        Raises:
            numpy.linalg.LinAlgError: at a singular configuration, without damping.
        """
        dq = self._solve(J, v, dq0)
        beyond = np.maximum(lower - dq, dq - upper)
        if beyond.max() <= 0.0:
            return dq
        free = np.ones(len(dq), dtype=bool)
        while beyond.max() > 0.0 and free.sum() > len(v):
            worst = int(np.argmax(beyond))
            free[worst] = False
            dq[worst] = min(max(dq[worst], lower[worst]), upper[worst])
            left = v - dot(J[:, ~free], dq[~free])
            try:
                dq[free] = self._solve(J[:, free], left, dq0[free], self._mobility[free])
            except np.linalg.LinAlgError:
                break  # the others are singular
            beyond = np.where(free, np.maximum(lower - dq, dq - upper), 0.0)
        return np.minimum(np.maximum(dq, lower), upper)

    def _solve(self, J: FloatArray, v: FloatArray, dq0: FloatArray, mobility: FloatArray | None = None) -> FloatArray:
        spread = (self._mobility if mobility is None else mobility)[:, None] * J.T
        A = J.dot(spread)
        if self._damping and self._is_near(A):
            smallest = max(float(eigen.SelfAdjointEigenSolver(A).eigenvalues()[0]), 0.0)
            A.flat[:: len(A) + 1] += max(self._damping**2 - smallest, 0.0)  # the diagonal
        return dq0 + dot(spread, solve_symmetric(A, v - dot(J, dq0), _SINGULAR))

    def _is_near(self, A: FloatArray) -> bool:
        """Return True if an eigenvalue of A is below damping^2; a Cholesky factorisation shows it faster."""
        above = A.copy()
        above.reshape(-1)[:: len(A) + 1] -= self._damping**2  # the diagonal
        return bool(eigen.LLT(above).info() != eigen.ComputationInfo.Success)
