"""The thesis' arms, twice: by Pinocchio, and as chains of Denavit-Hartenberg transforms with point masses."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from runner.audit.chains import derivative, product, rotation, translation
from runner.audit.truth import FloatArray, Symbols
from runner.config.compose import compose
from runner.config.validation import validate
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.works.thesis.equations.truths.thesis import vector_of

GRAVITY = np.array([0.0, 0.0, -9.81])  # m/s^2; specified in section 3.2
_HALF = np.pi / 2


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm by the measures of the thesis, its joints among the six of a sample.

    Attributes:
        joints: Its joints.
        theta: D-H angles at q = 0, in rad.
        d: D-H distances along the joint axes, in m.
        a: D-H link lengths, in m.
        alpha: D-H twists, in rad.
        masses: Point masses at the origins of frames 1 to n, in kg.
        model: The same arm in Pinocchio, from its URDF; its tip is frame n.
    """

    joints: slice
    theta: tuple[float, ...]
    d: tuple[float, ...]
    a: tuple[float, ...]
    alpha: tuple[float, ...]
    masses: tuple[float, ...]
    model: Callable[[], RobotModel]

    def q(self, values: Symbols) -> FloatArray:
        """Return its joint positions, shape (T, n), in rad."""
        return vector_of("q", values, self.joints)

    def dq(self, values: Symbols) -> FloatArray:
        """Return its joint velocities, shape (T, n), in rad/s."""
        return vector_of("dq", values, self.joints)

    def ddq(self, values: Symbols) -> FloatArray:
        """Return its joint accelerations, shape (T, n), in rad/s^2."""
        return vector_of("ddq", values, self.joints)

    def step(self, link: int, q: FloatArray) -> FloatArray:
        """Return the transform from frame i = link to frame i-1 at joint positions, shape (T, 4, 4)."""
        i = link - 1
        rest = product([translation("z", self.d[i]), translation("x", self.a[i]), rotation("x", self.alpha[i])])
        return rotation("z", self.theta[i] + q[:, i]) @ rest

    def frames(self, q: FloatArray) -> list[FloatArray]:
        """Return frames 0 to n in the base frame, shape (T, 4, 4) each."""
        found = [np.tile(np.eye(4), (len(q), 1, 1))]
        for link in range(1, len(self.a) + 1):
            found.append(found[-1] @ self.step(link, q))
        return found

    def frame(self, link: int, q: FloatArray) -> FloatArray:
        """Return frame i = link in the base frame, shape (T, 4, 4); frame 0 is the base."""
        return self.frames(q)[link]

    def end_jacobian(self, link: int, q: FloatArray) -> FloatArray:
        """Return the Jacobian of frame i's origin by z x (p - o), linear rows first, shape (T, 6, n)."""
        J, frames = np.zeros((len(q), 6, q.shape[1])), self.frames(q)
        for joint, before in enumerate(frames[:link]):
            axis = before[:, :3, 2]
            J[:, :3, joint] = np.cross(axis, frames[link][:, :3, 3] - before[:, :3, 3])
            J[:, 3:, joint] = axis
        return J

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return the sum of m J_v' J_v over the point masses, shape (T, n, n), in kg m^2."""
        Js = [np.sqrt(m) * self.end_jacobian(i, q)[:, :3] for i, m in enumerate(self.masses, start=1) if m]
        M: FloatArray = np.sum([J.transpose(0, 2, 1) @ J for J in Js], axis=0)
        return M

    def coriolis_torque(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the torques of the masses' accelerations at ddq = 0 by d'Alembert's principle, shape (T, n), in N m.

        They are the sum of m J_v' (dJ_v/dt) dq, with the rate of J_v by differences.
        """
        torque = np.zeros_like(q)
        for link, mass in enumerate(self.masses, start=1):
            if mass:
                J = self.end_jacobian(link, q)[:, :3]
                torque += mass * along(J.transpose(0, 2, 1), self.bias_acceleration(link, q, dq))
        return torque

    def bias_acceleration(self, link: int, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the acceleration of frame i's origin at ddq = 0, (dJ_v/dt) dq by differences, shape (T, 3)."""

        def velocity(time: FloatArray) -> FloatArray:
            return along(self.end_jacobian(link, q + time * dq)[:, :3], dq)

        return derivative(velocity, np.zeros((len(q), 1)), 0)

    def gravity_torque(self, q: FloatArray, gravity: FloatArray = GRAVITY) -> FloatArray:
        """Return the derivative of the masses' potential energy by differences, shape (T, n), in N m.

        Args:
            q: Joint positions, shape (T, n), in rad.
            gravity: Gravity in the base frame, shape (3,) or (T, 3), in m/s^2.
        """

        def energy(at: FloatArray) -> FloatArray:
            ends = zip(self.masses, self.frames(at)[1:], strict=True)
            total: FloatArray = sum(-m * (frame[:, :3, 3] * gravity).sum(axis=1) for m, frame in ends)
            return total

        return np.column_stack([derivative(energy, q, joint) for joint in range(q.shape[1])])


def along(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return each matrix times its vector, shapes (T, m, n) and (T, n) to (T, m)."""
    result: FloatArray = np.einsum("tij,tj->ti", matrices, vectors)
    return result


@cache
def combined_robot() -> Robot:
    """Return the Mini on the Macro as robot=combined builds it; its stages are the two arms alone."""
    return validate(compose(("robot=combined",)).resolved).arm


MACRO = Arm(
    slice(0, 3),
    (_HALF, 0.0, _HALF),
    (0.0, 0.0, 0.0),
    (0.0, 1.0, 1.0),
    (_HALF, 0.0, _HALF),
    (0.0, 1.0, 1.0),
    lambda: combined_robot().stages[0].model,
)
"""The Macro of Tables 2.1 and 3.1."""

MINI = Arm(
    slice(3, 6),
    (_HALF, 0.0, _HALF),
    (0.0, 0.0, 0.0),
    (0.0, 0.1, 0.1),
    (_HALF, 0.0, _HALF),
    (0.0, 0.1, 0.1),
    lambda: combined_robot().stages[1].model,
)
"""The Mini of Tables 2.1 and 4.1, on a base of its own, frame 3."""

COMBINED = Arm(
    slice(0, 6),
    (_HALF, 0.0, np.pi, np.pi, 0.0, _HALF),
    (0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0, 0.1, 0.1),
    (_HALF, 0.0, _HALF, _HALF, 0.0, _HALF),
    (0.0, 1.0, 0.0, 1.0, 0.1, 0.1),
    lambda: combined_robot().model,
)
"""The Mini on the Macro, joint 4 along link 3: the table that the appendix was derived with (Table 5.1 is lost)."""
