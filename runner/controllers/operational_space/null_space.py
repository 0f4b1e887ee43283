"""Null-space tasks of a redundant arm: configuration, joint limits or manipulability."""

from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, JointSpeed, PerSecond


class NullSpaceConfig(StrictModel):
    """Config of the null-space task.

    Attributes:
        task: What is sought: a posture, the middle of the joints' ranges, the largest manipulability, or nothing (the
            joint motion is then the shortest).
        gain: How fast, in 1/s.
        posture: The posture sought, in rad; m where a joint slides. None is home.
        max_speed: Largest joint speed asked for, in rad/s; m/s where a joint slides. None is no limit.
    """

    task: Literal["none", "posture", "joint_limits", "manipulability"]
    gain: PerSecond[NonNegativeFloat]
    posture: JointPosition[list[float] | None]
    max_speed: JointSpeed[PositiveFloat | None]


class NullSpaceTask:
    r"""Joint velocities that a task asks for, to be projected into the null space of the tip's.

    - posture: k (q_rest - q);
    - joint_limits: k (q_mid - q) / d^2 per joint, d half its range: downhill on Liegeois' sum of squared distances
      from the middle (IEEE Transactions on Systems, Man and Cybernetics 7(12), 1977); zero for unlimited joints;
    - manipulability: k times the gradient of ln w, with Yoshikawa's w = sqrt(det J J^T).

    Args:
        config: The task's numbers.
        rest: Posture sought, shape (nq,), in rad.
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
        """Return the joint velocities asked for, shape (nq,), in rad/s.

        Args:
            q: Joint positions, shape (nq,), in rad.
            J: The tip's basic Jacobian in the base frame, shape (6, nq).
            directions: What the tip's task asks for, shape (rows, 3) for the position, (rows, 6) for the pose; see
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
        fastest = float(np.abs(velocity).max())
        if self._max_speed is not None and fastest > self._max_speed:
            velocity *= self._max_speed / fastest
        return velocity


def manipulability(J: FloatArray) -> float:
    """Return Yoshikawa's w = sqrt(det J J^T) of a Jacobian, shape (m, nq)."""
    return float(np.sqrt(max(np.linalg.det(J @ J.T), 0.0)))


def log_manipulability_gradient(J: FloatArray, directions: FloatArray) -> FloatArray:
    r"""Return the gradient of ln w with respect to the joint positions, shape (nq,), in 1/rad.

    .. math:: \partial \ln w / \partial q_k = \mathrm{tr}(J^+ \, \partial J / \partial q_k)

    A joint turns or shifts what comes after it: with j_i the linear and z_i the angular column of joint i (z_i = 0
    where it slides),
    dj_i/dq_k = z_k x j_i and dz_i/dq_k = z_k x z_i for k <= i, dj_i/dq_k = z_i x j_k and dz_i/dq_k = 0 for k > i.

    Args:
        J: The tip's basic Jacobian in the base frame, shape (6, nq).
        directions: What w is of, shape (rows, 3) for the position, (rows, 6) for the pose.

    Raises:
        numpy.linalg.LinAlgError: at a singular posture.
    """
    linear, angular = J[:3].T, J[3:].T
    first = np.minimum.outer(np.arange(len(linear)), np.arange(len(linear)))  # [k, i]: the one nearer to the base
    last = np.maximum.outer(np.arange(len(linear)), np.arange(len(linear)))
    dJ = np.cross(angular[first], linear[last])  # [k, i, row]
    if directions.shape[1] == 6:
        upstream = np.tril(np.ones((len(linear), len(linear)))).T[:, :, None]  # k <= i
        dJ = np.concatenate([dJ, upstream * np.cross(angular[first], angular[last])], axis=2)
    dJ = dJ @ directions.T
    task = directions @ J[: directions.shape[1]]
    inverse = np.linalg.solve(task @ task.T, task)  # (J J^T)^-1 J, the transpose of J^+
    gradient: FloatArray = np.einsum("ri,kir->k", inverse, dJ)
    return gradient
