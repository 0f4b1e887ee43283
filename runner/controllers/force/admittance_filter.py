"""Admittance filter from wrench to motion: mass, damper, spring (Meca500 report, section 5)."""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin

AXES = ("x", "y", "z", "rotation x", "rotation y", "rotation z")


@dataclass(frozen=True)
class Admittance:
    r"""The law of each axis, three of translation and three of rotation (report eq. 8).

    .. math:: M \ddot x + B \dot x + K x = f

    Attributes:
        mass: M, shape (6,), in kg and kg m^2.
        damping: B, shape (6,), in N s/m and N m s/rad.
        stiffness: K, shape (6,), in N/m and N m/rad; 0 lets an axis be guided by hand.

    Raises:
        ConfigError: if M is not positive definite, or B or K not positive semi-definite; the message lists the axes.
    """

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray

    def __post_init__(self) -> None:
        problems = []
        for name, letter, values in (
            ("mass", "M", self.mass),
            ("damping", "B", self.damping),
            ("stiffness", "K", self.stiffness),
        ):
            allowed = values > 0.0 if name == "mass" else values >= 0.0
            wrong = [f"{value:g} for {axis}" for axis, value, ok in zip(AXES, values, allowed, strict=True) if not ok]
            if wrong:
                bound, definite = ("above 0", "definite") if name == "mass" else ("0 or more", "semi-definite")
                problems.append(
                    f"controller.{name}: {letter} must be positive {definite}: allowed on each axis: {bound}; "
                    f"found {', '.join(wrong)}"
                )
        if problems:
            raise ConfigError(problems)


def held_map(A: FloatArray, B: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    r"""Return the exact map over a period h of dx/dt = A x + B u with constant u (zero-order hold).

    .. math::

        \begin{pmatrix} \Phi & \Gamma \\ 0 & 1 \end{pmatrix} = \exp \left( h
        \begin{pmatrix} A & B \\ 0 & 0 \end{pmatrix} \right)

    Args:
        A: Shape (..., n, n).
        B: Shape (..., n, m).
        period: h, in s.

    Returns:
        Phi, shape (..., n, n), and Gamma, shape (..., n, m): x at the end is Phi x + Gamma u.
    """
    from scipy.linalg import expm  # only a few configs need it

    n, m = B.shape[-2:]
    continuous = np.zeros((*A.shape[:-2], n + m, n + m))
    continuous[..., :n, :n], continuous[..., :n, n:] = A, B
    sampled: FloatArray = expm(period * continuous)
    return sampled[..., :n, :n], sampled[..., :n, n:]


def discretise(law: Admittance, period: float) -> tuple[FloatArray, FloatArray]:
    """Return the law sampled exactly for a load that is constant over a period, in s; see held_map.

    Returns:
        Phi, shape (6, 2, 2), and Gamma, shape (6, 2): (x, dx) at the next sample is Phi (x, dx) + Gamma f.
    """
    rates = np.column_stack([-law.stiffness, -law.damping, np.ones(6)]) / law.mass[:, None]
    A, B = np.zeros((6, 2, 2)), np.zeros((6, 2, 1))
    A[:, 0, 1], A[:, 1], B[:, 1, 0] = 1.0, rates[:, :2], rates[:, 2]
    Phi, Gamma = held_map(A, B, period)
    return Phi, Gamma[..., 0]


class AdmittanceFilter:
    """The law as a filter from a wrench to a displacement of a frame, sampled exactly at any rate.

    The axes are those of the fixed frame of the wrench. Rotation is that of a rigid body. The moment accelerates the
    angular velocity along the fixed axes, each period's rotation is composed onto the last one, and the spring acts
    along the rotation vector (the logarithm). About one axis this is the law to rounding. If the axis changes, it
    converges with the period. The report integrates angles instead.

    Args:
        law: The law.
        period: Time between two steps, in s.
    """

    def __init__(self, law: Admittance, period: float) -> None:
        Phi, Gamma = discretise(law, period)
        (self._xx, self._xv), (self._vx, self._vv) = Phi.transpose(1, 2, 0)
        self._xf, self._vf = Gamma.T
        self.reset()

    def reset(self) -> None:
        """Start at rest with the spring relaxed."""
        self._displacement = np.zeros(6)
        self._velocity = np.zeros(6)
        self._rotation = pin.Quaternion.Identity()

    @property
    def translation(self) -> FloatArray:
        """Displacement from the relaxed spring, shape (3,), in m."""
        return self._displacement[:3].copy()

    @property
    def rotation(self) -> FloatArray:
        """Rotation from the relaxed spring, shape (3, 3)."""
        matrix: FloatArray = self._rotation.matrix()
        return matrix

    @property
    def displacement(self) -> FloatArray:
        """Translation in m and rotation vector in rad, at most half a turn, shape (6,)."""
        return self._displacement.copy()

    @property
    def velocity(self) -> FloatArray:
        """Linear velocity in m/s and angular velocity in rad/s, shape (6,)."""
        return self._velocity.copy()

    def place(self, translation: FloatArray, rotation: FloatArray, velocity: FloatArray) -> None:
        """Set the state of the filter to that of a constrained frame.

        Args:
            translation: Displacement, shape (3,), in m.
            rotation: Rotation, shape (3, 3).
            velocity: Linear velocity in m/s and angular velocity in rad/s, shape (6,).
        """
        self._rotation = pin.Quaternion(rotation)
        self._displacement = np.concatenate([translation, pin.log3(self._rotation.coeffs())])
        self._velocity = velocity.copy()

    def step(self, wrench: FloatArray) -> None:
        """Advance one period under a wrench, force in N and moment in N m, shape (6,)."""
        x, v = self._displacement, self._velocity
        moved = self._xx * x + self._xv * v + self._xf * wrench
        self._velocity = self._vx * x + self._vv * v + self._vf * wrench
        self._rotation = pin.Quaternion(pin.exp3_quat(moved[3:] - x[3:])) * self._rotation
        self._rotation.normalize()
        moved[3:] = pin.log3(self._rotation.coeffs())
        self._displacement = moved
