"""Arms of the thesis: URDF models, and Denavit-Hartenberg chains with point masses."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.paths import studies_dir
from runner.papers.audit.derivations import (
    Derivations,
    Elements,
    Symbols,
    along,
    derivative,
    product,
    rotation,
    translation,
)
from runner.papers.audit.model_derivations import AuditedArm, Dynamics, audited_arm, by_model, by_urdf
from runner.papers.studies.thesis.equations.derivations.thesis import JOINTS
from runner.robots.model import RobotModel

GRAVITY = np.array([0.0, 0.0, -9.81])  # m/s^2; specified in section 3.2
_HALF = np.pi / 2


@dataclass(frozen=True, eq=False)
class ThesisArm:
    """An arm by the measures of the thesis, its joints among the six of a sample.

    Attributes:
        robot: Name of its config; the tip there is frame n.
        joints: Its joints.
        theta: D-H angles at q = 0, in rad.
        d: D-H distances along the joint axes, in m.
        a: D-H link lengths, in m.
        alpha: D-H twists, in rad.
        masses: Point masses at the origins of frames 1 to n, in kg.
    """

    robot: str
    joints: slice
    theta: tuple[float, ...]
    d: tuple[float, ...]
    a: tuple[float, ...]
    alpha: tuple[float, ...]
    masses: tuple[float, ...]

    @cached_property
    def audited(self) -> AuditedArm:
        """The same arm by its URDF."""
        joints = tuple(f"q{i + 1}" for i in range(JOINTS)[self.joints])
        return audited_arm(self.robot, "", joints, studies_dir() / "thesis")

    @property
    def model(self) -> RobotModel:
        """The same in Pinocchio."""
        return self.audited.model

    def both(self, found: Callable[[Dynamics, Symbols], Elements]) -> Derivations:
        """Return derivations of what follows from the arm's dynamics, by Pinocchio and by the URDF's bodies."""
        first, second = by_model(self.model), by_urdf(self.audited.urdf, self.model)
        methods = ("Pinocchio", "the URDF's transforms and energies, and differences of them")
        return Derivations(lambda s: found(first, s), lambda s: found(second, s), methods)

    def q(self, values: Symbols) -> FloatArray:
        """Return its joint positions, shape (T, n), in rad."""
        return self.audited.motion(values)[0]

    def dq(self, values: Symbols) -> FloatArray:
        """Return its joint velocities, shape (T, n), in rad/s."""
        return self.audited.motion(values)[1]

    def ddq(self, values: Symbols) -> FloatArray:
        """Return its joint accelerations, shape (T, n), in rad/s^2."""
        return self.audited.motion(values)[2]

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

    def bias_acceleration(self, link: int, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the acceleration of frame i's origin at ddq = 0, (dJ_v/dt) dq by differences, shape (T, 3)."""

        def velocity(time: FloatArray) -> FloatArray:
            return along(self.end_jacobian(link, q + time * dq)[:, :3], dq)

        return derivative(velocity, np.zeros((len(q), 1)), 0)

    def weight(self, q: FloatArray, gravity: FloatArray = GRAVITY) -> FloatArray:
        """Return minus the sum of m J_v' g over the point masses, (3.24), g in the base frame; shape (T, n), in N m."""
        g = np.broadcast_to(gravity, (len(q), 3))
        torque = np.zeros_like(q)
        for link, mass in enumerate(self.masses, start=1):
            torque -= mass * along(self.end_jacobian(link, q)[:, :3].transpose(0, 2, 1), g)
        return torque


_HOME, _TWISTS = (_HALF, 0.0, _HALF), (_HALF, 0.0, _HALF)

MACRO = ThesisArm("macro", slice(0, 3), _HOME, (0.0, 0.0, 0.0), (0.0, 1.0, 1.0), _TWISTS, (0.0, 1.0, 1.0))
"""The Macro of Tables 2.1 and 3.1."""

MINI = ThesisArm("mini", slice(3, 6), _HOME, (0.0, 0.0, 0.0), (0.0, 0.1, 0.1), _TWISTS, (0.0, 0.1, 0.1))
"""The Mini of Tables 2.1 and 4.1, with frame 3 as its base."""

COMBINED = ThesisArm(
    "combined",
    slice(0, 6),
    (_HALF, 0.0, np.pi, np.pi, 0.0, _HALF),
    (0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0, 0.1, 0.1),
    (_HALF, 0.0, _HALF, _HALF, 0.0, _HALF),
    (0.0, 1.0, 0.0, 1.0, 0.1, 0.1),
)
"""The Mini on the Macro, joint 4 along link 3: the table that the appendix was derived with (Table 5.1 is lost)."""
