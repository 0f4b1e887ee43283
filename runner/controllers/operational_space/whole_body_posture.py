"""Posture task in the null space of the tip task, for a redundant arm."""

from typing import NamedTuple, Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel
from runner.symbolic.maths import Array, Backend, Scalar


class PostureNumbers(NamedTuple):
    """The numbers of a posture task.

    Attributes:
        k_p: omega_n^2, in 1/s^2.
        k_v: 2 omega_n, in 1/s.
        rest: The posture, shape (nq,), in rad.
        stiffness: K of a spring, shape (nq, nq), in N m/rad.
    """

    k_p: Scalar
    k_v: Scalar
    rest: Array
    stiffness: Array


class Posture(Protocol):
    """A posture task; its torque is M a + s, before the tip's part is taken out of it."""

    @property
    def numbers(self) -> PostureNumbers:
        """Its numbers."""
        ...

    def acceleration_and_torque(
        self, backend: Backend, numbers: PostureNumbers, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return a joint acceleration a, in rad/s^2, and a torque s, in N m or None, both of shape (nq,).

        Args:
            backend: The functions over the scalars of these arrays.
            numbers: The task's numbers.
            J: Jacobian of the tip's task, shape (rows, nq).
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, likewise, in rad/s.
        """
        ...


class JointStiffness:
    r"""Joints from one on are held, and all are damped.

    .. math:: \tau_0 = -k_{vn} M \dot q - K (q - q_\mathrm{rest})

    Damping alone would let a Mini that rides on a Macro stretch. K is constant, symmetric, and zero but for the joints
    whose posture is held: a spring, so that the posture can only lose energy while the tip rests. At rest it gives them
    omega_n = frequency: K is omega_n^2 times the inertia that they meet there with the tip held. An acceleration,
    M S (q - q_rest), is no spring: of one of the Mini's joints alone N^T leaves nothing at home.

    Args:
        model: The arm.
        frequency: omega_n of the posture, in rad/s.
        rest: The posture, shape (nq,), in rad.
        first: The first joint that is held, and with it all after it; as many as the tip's position takes stay free.
    """

    def __init__(self, model: RobotModel, frequency: float, rest: FloatArray, first: int) -> None:
        stiffness = frequency**2 * _inertia_at_rest(model, rest, first)
        self.numbers = PostureNumbers(frequency**2, 2.0 * frequency, rest, stiffness)

    def acceleration_and_torque(
        self, backend: Backend, numbers: PostureNumbers, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return -k_vn dq and the spring's torque; see Posture."""
        return -numbers.k_v * dq, numbers.stiffness.dot(numbers.rest - q)


class PostureTask:
    r"""All joints are drawn to a posture, as far as the tip's task leaves them.

    .. math:: \tau_0 = M (1 - J^+ J) (-2 \omega_n \dot q - \omega_n^2 (q - q_\mathrm{rest}))

    While the tip rests, |dq|^2 + omega_n^2 |q - q_rest|^2 falls, and the arm ends where it is nearest to the posture
    counted in joint angles. A spring of every joint's own inertia would count in these: it turns the light wrist of an
    arm by radians before it moves the heavy shoulder.

    Args:
        frequency: omega_n of the posture, in rad/s.
        rest: The posture, shape (nq,), in rad.
    """

    def __init__(self, frequency: float, rest: FloatArray) -> None:
        self.numbers = PostureNumbers(frequency**2, 2.0 * frequency, rest, np.zeros((0, 0)))

    def acceleration_and_torque(
        self, backend: Backend, numbers: PostureNumbers, J: Array, q: Array, dq: Array
    ) -> tuple[Array, Array | None]:
        """Return the joint acceleration that the tip does not feel, and no torque; see Posture."""
        return null_space_projection(backend, J, posture_pd(numbers, q, dq)), None


def posture_pd(numbers: PostureNumbers, q: Array, dq: Array) -> Array:
    """Return the joint acceleration towards a posture, whatever the tip does, shape (nq,), in rad/s^2."""
    return np.asarray(numbers.k_p * (numbers.rest - q) - numbers.k_v * dq)


def null_space_projection(backend: Backend, J: Array, ddq: Array) -> Array:
    """Return (1 - J^+ J) ddq, shapes (rows, nq) and (nq,); smooth through singular postures."""
    square = J.dot(J.T)
    square = square + 1e-12 * sum(square[i, i] for i in range(len(square))) * np.eye(len(square))
    return np.asarray(ddq - J.T.dot(backend.solve_symmetric(square, J.dot(ddq), None)))


def _inertia_at_rest(model: RobotModel, rest: FloatArray, first: int) -> FloatArray:
    """Return the inertia that the joints from a first one on meet at rest, shape (nq, nq), zero for the others."""
    inertia = np.zeros((model.nq, model.nq))
    held = slice(first, model.nq)
    M, J = model.mass_matrix(rest), model.tip_jacobian(rest)[:3]
    M_inverse = np.linalg.pinv(M, hermitian=True)
    mobility = M_inverse - M_inverse @ J.T @ np.linalg.pinv(J @ M_inverse @ J.T, hermitian=True) @ J @ M_inverse
    inertia[held, held] = np.linalg.pinv(mobility[held, held], hermitian=True)
    return inertia
