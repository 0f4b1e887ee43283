"""The xArm7 report's own formulas, as they are printed and put right one at a time: its chain, P_e, q2 and q4."""

import math
from dataclasses import dataclass

import numpy as np

from runner.robots.model import FloatArray, RobotModel

L1, L2, L3, L4, L5 = 0.267, 0.293, 0.0525, 0.3512, 0.1232  # m; the report prints them in cm
THETA1, THETA2 = 0.2225, 0.6646  # rad
CENTIMETRES = 100.0
"""What one unit of length is divided into in the report's formulas."""


def chain_tip(q: FloatArray) -> FloatArray:
    """Return the tip's position by the entries A14, A24, A34 of the printed transform A07, shape (3,), in m.

    Args:
        q: Joint positions, shape (7,), in rad.
    """
    forearm = L4 * math.cos(THETA1), L4 * math.sin(THETA1)
    return _tip(q, forearm, (L5 * math.cos(THETA2), L5 * math.sin(THETA2)))


def printed_tip(q: FloatArray) -> FloatArray:
    """Return P_e as printed, with q1 in place of theta1 and with q5 and q2 in place of theta2, shape (3,), in m."""
    forearm = L4 * math.cos(q[0]), L4 * math.sin(q[0])
    return _tip(q, forearm, (L5 * math.cos(q[4]), L5 * math.sin(q[1])))


def _tip(q: FloatArray, forearm: tuple[float, float], hand: tuple[float, float]) -> FloatArray:
    """Return the printed sums, with their parts as vectors: upper arm, l4 along and across it, l5.

    Args:
        q: Joint positions, shape (7,), in rad.
        forearm: What stands for l4 cos theta1 and l4 sin theta1, in m.
        hand: What stands for l5 cos theta2 and l5 sin theta2, in m.
    """
    s1, s2, s3, s4, s5, s6 = np.sin(q[:6])
    c1, c2, c3, c4, c5, c6 = np.cos(q[:6])
    u, v = s1 * s3 - c1 * c2 * c3, c1 * s3 + c2 * c3 * s1
    w, n = c3 * s1 + c1 * c2 * s3, c1 * c3 - c2 * s1 * s3
    upper = np.array([L2 * c1 * s2 - L3 * u, L2 * s1 * s2 + L3 * v, L1 + L2 * c2 - L3 * c3 * s2])
    along = np.array([-(s4 * u + c1 * c4 * s2), s4 * v - c4 * s1 * s2, -(c2 * c4 + c3 * s2 * s4)])
    across = np.array([-(c4 * u - c1 * s2 * s4), c4 * v + s1 * s2 * s4, c2 * s4 - c3 * c4 * s2])
    turned = c5 * across + s5 * np.array([w, -n, -s2 * s3])
    tip: FloatArray = (
        upper
        + forearm[0] * along
        + forearm[1] * across
        + hand[0] * (c6 * along - s6 * turned)
        + hand[1] * (s6 * along + c6 * turned)
    )
    return tip


@dataclass(frozen=True)
class Mended:
    """Which misprints of the inverse kinematics are put right.

    Attributes:
        root: M^2 stands inside the root of q4.
        sign: q2's denominator is p4 r + p3 z.
        unit: What one metre is in the unit of length that is put in; M^2 outside the root makes it count.
    """

    root: bool
    sign: bool
    unit: float = CENTIMETRES


def printed_inverse(tip: FloatArray, wrist: float, mended: Mended) -> FloatArray:
    """Return q1, q2 and q4 by the printed formulas, shape (3,), in rad (section "inverse kinematic control").

    Args:
        tip: Tip position in the base frame, shape (3,), in m.
        wrist: q6, in rad.
        mended: What is put right in them.
    """
    x, y, z = mended.unit * tip
    l1, l2, l3, l4, l5 = mended.unit * np.array([L1, L2, L3, L4, L5])
    r, z = math.hypot(x, y), z - l1
    A = l4 * math.cos(THETA1) + l5 * math.cos(wrist - THETA2)
    B = l4 * math.sin(THETA1) - l5 * math.sin(wrist - THETA2)
    p1, p2 = -l2 * A + l3 * B, l2 * B + l3 * A
    M = 0.5 * (r * r + z * z - l2**2 - l3**2 - l4**2 - l5**2 - 2.0 * l4 * l5 * math.cos(wrist + THETA1 - THETA2))
    root = math.sqrt(p1 * p1 + p2 * p2 - M * M) if mended.root else math.sqrt(p1 * p1 + p2 * p2) - M * M
    q4 = math.atan(M / root) - math.atan(p1 / p2)
    p3 = l2 - A * math.cos(q4) + B * math.sin(q4)
    p4 = l3 + B * math.cos(q4) + A * math.sin(q4)
    q2 = math.atan((p3 * r - p4 * z) / (p4 * r + (p3 if mended.sign else -p3) * z))
    return np.array([math.atan2(y, x), q2, q4])


def random_postures(model: RobotModel, count: int) -> FloatArray:
    """Return postures spread evenly over the joint limits, shape (count, nq), in rad; always the same ones."""
    low, high = model.position_limits
    return np.random.default_rng(0).uniform(low, high, (count, model.nq))
