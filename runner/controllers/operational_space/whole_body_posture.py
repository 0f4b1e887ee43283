"""Posture task in the null space of the tip task, for a redundant arm."""

from typing import NamedTuple, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.torque_law import second_order
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Backend, Scalar


class PostureNumbers(NamedTuple):
    """The numbers of a posture task."""

    k_p: Scalar  # omega_n^2, in 1/s^2
    k_v: Scalar  # 2 omega_n, in 1/s
    rest: Array  # desired configuration, shape (nq,), in rad
    stiffness: Array  # K of the springs, shape (nq, nq), in N m/rad


class Posture(Protocol):
    """A posture task; its torque is M a + s, before the projection into the null space of the tip task."""

    @property
    def numbers(self) -> PostureNumbers:
        """Numbers of the task."""
        ...

    def acceleration_and_torque(
        self, backend: Backend, numbers: PostureNumbers, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return a joint acceleration a, in rad/s^2, and a torque s, in N m or None, both of shape (nq,).

        Args:
            backend: Functions over the scalars of these arrays.
            numbers: Numbers of the task.
            J: Jacobian of the tip task, shape (rows, nq).
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, shape (nq,), in rad/s.
        """
        ...


class JointStiffness:
    r"""Posture task with springs on the joints from `first` on, and damping of all joints.

    .. math:: \tau_0 = -k_{vn} M \dot q - K (q - q_\mathrm{rest})

    With damping only, a Mini on a Macro would stretch. K is constant, symmetric, and zero for the free joints. Because
    it is a spring, the posture only loses energy while the tip rests. K is omega_n^2 times the inertia of the held
    joints at q_rest with the tip fixed, so their natural frequency there is omega_n. An acceleration M S (q - q_rest)
    would not be a spring: at home N^T cancels it if it acts on a single Mini joint.

    Args:
        model: The arm.
        frequency: omega_n of the posture, in rad/s.
        rest: Desired configuration, shape (nq,), in rad.
        first: Index of the first joint with a spring; the joints before it stay free for the tip task.
    """

    def __init__(self, model: RobotModel, frequency: float, rest: FloatArray, first: int) -> None:
        stiffness = frequency**2 * _inertia_at_rest(model, rest, first)
        self.numbers = PostureNumbers(*second_order(frequency, 1.0), rest, stiffness)

    def acceleration_and_torque(
        self, backend: Backend, numbers: PostureNumbers, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return -k_vn dq and the torque of the springs; see Posture."""
        return -numbers.k_v * dq, numbers.stiffness.dot(numbers.rest - q)


class PostureTask:
    r"""Posture task that pulls all joints to a configuration, as far as the tip task allows.

    .. math:: \tau_0 = M (1 - J^+ J) (-2 \omega_n \dot q - \omega_n^2 (q - q_\mathrm{rest}))

    While the tip rests, |dq|^2 + omega_n^2 |q - q_rest|^2 decreases, and the arm ends at the nearest configuration to
    q_rest by joint angles. Springs in proportion to the joint inertias would weight the distance by inertia: they turn
    the light wrist of an arm by radians before they move the heavy shoulder.

    Args:
        frequency: omega_n of the posture, in rad/s.
        rest: Desired configuration, shape (nq,), in rad.
    """

    def __init__(self, frequency: float, rest: FloatArray) -> None:
        self.numbers = PostureNumbers(*second_order(frequency, 1.0), rest, np.zeros((0, 0)))

    def acceleration_and_torque(
        self, backend: Backend, numbers: PostureNumbers, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return the joint acceleration in the null space of the tip task, and None; see Posture."""
        return null_space_projection(backend, J, posture_pd(numbers, q, dq)), None


def posture_pd(numbers: PostureNumbers, q: Array, dq: Array) -> Array:
    """Return the joint acceleration towards a configuration, without projection, shape (nq,), in rad/s^2."""
    return np.asarray(numbers.k_p * (numbers.rest - q) - numbers.k_v * dq)


def null_space_projection(backend: Backend, J: Array, ddq: Array) -> Array:
    """Return (1 - J^+ J) ddq, shape (nq,), from shapes (rows, nq) and (nq,); smooth through singular configurations."""
    square = J.dot(J.T)
    square = square + 1e-12 * sum(square[i, i] for i in range(len(square))) * np.eye(len(square))
    return np.asarray(ddq - J.T.dot(backend.solve_symmetric(square, J.dot(ddq), None)))


def _inertia_at_rest(model: RobotModel, rest: FloatArray, first: int) -> FloatArray:
    """Return the inertia of the joints from `first` on with a fixed tip, shape (nq, nq); zero for the others."""
    inertia = np.zeros((model.nq, model.nq))
    held = slice(first, model.nq)
    M, J = model.mass_matrix(rest), model.tip_jacobian(rest)[:3]
    M_inverse = np.linalg.pinv(M, hermitian=True)
    mobility = M_inverse - M_inverse @ J.T @ np.linalg.pinv(J @ M_inverse @ J.T, hermitian=True) @ J @ M_inverse
    inertia[held, held] = np.linalg.pinv(mobility[held, held], hermitian=True)
    return inertia
