"""Closed-form inverse kinematics of the xArm7 with joints 3, 5 and 7 at zero and joint 6 fixed."""

import math
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.robots.model import RobotModel

MOVING = (0, 1, 3)
"""The joints that move: 1, 2 and 4."""


@dataclass(frozen=True)
class Branch:
    """One of the four ways to reach a point.

    Attributes:
        shoulder: 1 where the arm reaches forwards, towards the point, -1 where it turns its back and reaches over.
        elbow: Sign of the root in q4.
    """

    shoulder: int
    elbow: int


BRANCHES = tuple(Branch(shoulder, elbow) for shoulder in (1, -1) for elbow in (1, -1))


class ThreeJointArm:
    r"""The xArm7 moved only by joints 1, 2 and 4 (xArm7 report, section "inverse kinematic control").

    With A = l4 cos theta1 + l5 cos(q6 - theta2), B = l4 sin theta1 - l5 sin(q6 - theta2), r = +-hypot(x, y) and
    z' = z - l1, the shoulder's plane holds two links, (l3, l2) and (A, B), and

    .. math::

        q_1 &= \mathrm{atan2}(y, x) \;(+ \pi \text{ for } r < 0) \\
        q_4 &= \mathrm{atan2}(M, \pm\sqrt{p_1^2 + p_2^2 - M^2}) - \mathrm{atan2}(p_1, p_2) \\
        q_2 &= \mathrm{atan2}(p_3 r - p_4 z', \; p_4 r + p_3 z')

    p1 = -l2 A + l3 B, p2 = l2 B + l3 A, M = (r^2 + z'^2 - l2^2 - l3^2 - A^2 - B^2) / 2, p3 = l2 - A c4 + B s4,
    p4 = l3 + B c4 + A s4. The report prints q2's denominator with a minus, M^2 outside the root, and arctan
    where the quadrant counts.

    Args:
        model: The arm; its chain must be the xArm7's, up to its lengths.
        wrist: q6, in rad.

    Raises:
        ConfigError: if the arm has another chain.
    """

    def __init__(self, model: RobotModel, wrist: float) -> None:
        self._wrist = wrist
        placements = [placement.translation for placement in model.pin_model.jointPlacements]
        if model.nq == 7:
            self._l1, self._l2, self._l3 = placements[1][2], -placements[3][1], placements[4][0]
            a4, b4 = -placements[5][1], placements[5][0]  # l4 cos and sin theta1
            a5, b5 = placements[7][1], placements[7][0]  # l5 cos and sin theta2
            c6, s6 = math.cos(wrist), math.sin(wrist)
            self._A = a4 + a5 * c6 + b5 * s6
            self._B = b4 - a5 * s6 + b5 * c6
        self._check(model)

    def _check(self, model: RobotModel) -> None:
        probe = np.array([0.3, 0.5, -0.7])
        fits = model.nq == 7 and np.allclose(self.tip(*probe), model.tip_position(self.posture(*probe)), atol=1e-9)
        if not fits:
            raise ConfigError(
                "controller.kind: three_joint solves the xArm7's chain with joints 1, 2 and 4; this arm's is "
                f"another (joints {', '.join(model.joint_names)}); take differential_inverse_kinematics"
            )

    def posture(self, q1: float, q2: float, q4: float) -> FloatArray:
        """Return all seven joint positions, shape (7,), in rad."""
        return np.array([q1, q2, 0.0, q4, 0.0, self._wrist, 0.0])

    def tip(self, q1: float, q2: float, q4: float) -> FloatArray:
        """Return the tip's position in the base frame, shape (3,), in m: forward kinematics of the three joints."""
        p3, p4 = self._links(q4)
        r = p3 * math.sin(q2) + p4 * math.cos(q2)
        z = p3 * math.cos(q2) - p4 * math.sin(q2)
        return np.array([r * math.cos(q1), r * math.sin(q1), z + self._l1])

    def _links(self, q4: float) -> tuple[float, float]:
        c4, s4 = math.cos(q4), math.sin(q4)
        return self._l2 - self._A * c4 + self._B * s4, self._l3 + self._B * c4 + self._A * s4

    def solve(self, tip: FloatArray, branch: Branch) -> FloatArray:
        """Return the seven joint positions that bring the tip to a point, shape (7,), in rad, angles in (-pi, pi].

        Args:
            tip: Tip position in the base frame, shape (3,), in m.
            branch: Which of the four ways.

        Raises:
            numpy.linalg.LinAlgError: if the point cannot be reached; says how far out it is.
        """
        x, y, z = (float(value) for value in tip)
        z -= self._l1
        r = branch.shoulder * math.hypot(x, y)
        p1, p2 = -self._l2 * self._A + self._l3 * self._B, self._l2 * self._B + self._l3 * self._A
        first, second = math.hypot(self._l2, self._l3), math.hypot(self._A, self._B)
        M = 0.5 * (r * r + z * z - first**2 - second**2)
        square = p1 * p1 + p2 * p2 - M * M
        if square < 0.0:
            distance, longest, shortest = math.hypot(r, z), first + second, abs(first - second)
            far, near = distance - longest, shortest - distance
            out = f"{far:.4g} m too far" if far > 0.0 else f"{near:.4g} m too near"
            raise np.linalg.LinAlgError(
                f"three joints cannot reach {[round(float(value), 4) for value in tip]} m: {distance:.4g} m from the "
                f"shoulder, {out} (they reach {shortest:.4g} to {longest:.4g} m)"
            )
        q4 = _wrap(math.atan2(M, branch.elbow * math.sqrt(square)) - math.atan2(p1, p2))
        p3, p4 = self._links(q4)
        q2 = math.atan2(p3 * r - p4 * z, p4 * r + p3 * z)
        q1 = math.atan2(branch.shoulder * y, branch.shoulder * x)
        return self.posture(q1, q2, q4)


def _wrap(angle: float) -> float:
    """Return the angle in (-pi, pi]."""
    return -math.remainder(-angle, 2.0 * math.pi)
