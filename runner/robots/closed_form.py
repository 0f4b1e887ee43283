"""The matrices that the thesis prints for its two arms, as functions: a check of the model, and of the thesis.

Both arms have joints about z, x, x, links of length 0, L, L and point masses 0, m, m at the link ends; the thesis
prints the Macro's matrices (L = 1 m, m = 1 kg) in chapter 3 and the Mini's (L = 0.1 m, m = 0.1 kg) in chapter 4.
q has shape (3,), in rad; everything is given in the arm's base frame. Abbreviations are those of section 3.1:
c12 = cos(q1 + q2), s1_2 = sin(q1 - q2), c1_2_3 = cos(q1 - q2 - q3).
"""

from collections.abc import Callable

import numpy as np
from numpy import cos, sin

from runner.robots.model import STANDARD_GRAVITY, FloatArray, RobotModel


def tip_transform(q: FloatArray, L: float) -> FloatArray:
    """Return 0T_E (below Table 3.1), or 3T_6 of the Mini (below Table 4.1), shape (4, 4)."""
    q1, q2, q3 = q
    c123, s123 = cos(q1 + q2 + q3), sin(q1 + q2 + q3)
    c1_2_3, s1_2_3 = cos(q1 - q2 - q3), sin(q1 - q2 - q3)
    c12, s12, c1_2, s1_2 = cos(q1 + q2), sin(q1 + q2), cos(q1 - q2), sin(q1 - q2)
    c23, s23 = cos(q2 + q3), sin(q2 + q3)
    return np.array(
        [
            [-c123 / 2 + c1_2_3 / 2, cos(q1), -s123 / 2 - s1_2_3 / 2, L * (-c123 + c1_2_3 - s12 - s1_2) / 2],
            [s1_2_3 / 2 - s123 / 2, sin(q1), c1_2_3 / 2 + c123 / 2, L * (s1_2_3 - s123 + c1_2 + c12) / 2],
            [c23, 0.0, s23, L * (c23 + sin(q2))],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def basic_jacobian(q: FloatArray, L: float) -> FloatArray:
    """Return the basic Jacobian 0J_M of eq. (3.7), linear rows first, shape (6, 3).

    Column 1 is written as the Mini's 3J_m of eq. (4.3) has it, in half-angle sums; chapter 3 prints the same as
    products. In J_v6 of section 4.2 the element (3, 2) lacks the factor 1/10, that is L, which is mended here.
    """
    q1, q2, q3 = q
    c123, s123 = cos(q1 + q2 + q3), sin(q1 + q2 + q3)
    c1_2_3, s1_2_3 = cos(q1 - q2 - q3), sin(q1 - q2 - q3)
    c12, s12, c1_2, s1_2 = cos(q1 + q2), sin(q1 + q2), cos(q1 - q2), sin(q1 - q2)
    s23 = sin(q2 + q3)
    linear = np.array(
        [
            [(s123 - s1_2_3 - c12 - c1_2) / 2, (s123 + s1_2_3 - c12 + c1_2) / 2, (s123 + s1_2_3) / 2],
            [(-c123 + c1_2_3 - s12 - s1_2) / 2, (-c123 - c1_2_3 - s12 + s1_2) / 2, (-c123 - c1_2_3) / 2],
            [0.0, -s23 + cos(q2), -s23],
        ]
    )
    angular = np.array([[0.0, cos(q1), cos(q1)], [0.0, sin(q1), sin(q1)], [1.0, 0.0, 0.0]])
    return np.vstack([L * linear, angular])


def mass_matrix(q: FloatArray, L: float, m: float) -> FloatArray:
    """Return the inertia matrix M(q) of eq. (3.17), shape (3, 3), in kg m^2."""
    _, q2, q3 = q
    s3 = sin(q3)
    M11 = 3 / 2 - cos(2 * q3 + 2 * q2) / 2 - s3 - sin(q3 + 2 * q2) + cos(2 * q2)
    return m * L**2 * np.array([[M11, 0.0, 0.0], [0.0, 3 - 2 * s3, 1 - s3], [0.0, 1 - s3, 1.0]])


def centrifugal_matrix(q: FloatArray, L: float, m: float) -> FloatArray:
    """Return C(q) of eq. (3.21), the factor of [dq1^2, dq2^2, dq3^2], shape (3, 3), in kg m^2."""
    _, q2, q3 = q
    c3, c223, s2233 = cos(q3), cos(q3 + 2 * q2), sin(2 * q3 + 2 * q2)
    return (
        m
        * L**2
        * np.array(
            [
                [0.0, 0.0, 0.0],
                [c223 + sin(2 * q2) - s2233 / 2, 0.0, -c3],
                [c3 / 2 + c223 / 2 - s2233 / 2, c3, 0.0],
            ]
        )
    )


def coriolis_matrix(q: FloatArray, L: float, m: float) -> FloatArray:
    """Return B(q) of eq. (3.20), the factor of [dq1 dq2, dq1 dq3, dq2 dq3], shape (3, 3), in kg m^2."""
    _, q2, q3 = q
    c3, c223, s2233 = cos(q3), cos(q3 + 2 * q2), sin(2 * q3 + 2 * q2)
    return (
        m
        * L**2
        * np.array(
            [
                [-2 * c223 - 2 * sin(2 * q2) + s2233, -c3 - c223 + s2233, 0.0],
                [0.0, 0.0, -2 * c3],
                [0.0, 0.0, 0.0],
            ]
        )
    )


def coriolis_torque(q: FloatArray, dq: FloatArray, L: float, m: float) -> FloatArray:
    """Return V(q, dq) = C [dq^2] + B [dq dq] of eq. (3.19), shape (3,), in N m."""
    products = np.array([dq[0] * dq[1], dq[0] * dq[2], dq[1] * dq[2]])
    V: FloatArray = centrifugal_matrix(q, L, m) @ dq**2 + coriolis_matrix(q, L, m) @ products
    return V


def gravity_torque(q: FloatArray, L: float, m: float, g: float = STANDARD_GRAVITY) -> FloatArray:
    """Return G(q) of eq. (3.24), shape (3,), in N m.

    The text has s2 and "s2 s3" where s23 = sin(q2 + q3) is meant. The Mini's G in section 4.2 holds only while its
    base, frame 3, stands upright.
    """
    _, q2, q3 = q
    s23 = sin(q2 + q3)
    return m * g * L * np.array([0.0, 2 * cos(q2) - s23, -s23])


def compare(model: RobotModel, L: float, m: float, samples: int, generator: np.random.Generator) -> dict[str, float]:
    """Return the largest absolute difference between the printed matrices and the model, by symbol.

    Args:
        model: The arm's model; its tip frame is the thesis' frame E (or 6).
        L: Length of links 2 and 3, in m.
        m: Mass at the ends of links 2 and 3, in kg.
        samples: Number of random states, positions within +-pi rad and velocities within +-1 rad/s.
        generator: Source of the states.

    Returns:
        Differences of M, V, G, J and T (the tip's transform), each in the unit of its quantity.
    """
    pairs: dict[str, Callable[[FloatArray, FloatArray], FloatArray]] = {
        "M": lambda q, dq: mass_matrix(q, L, m) - model.mass_matrix(q),
        "V": lambda q, dq: coriolis_torque(q, dq, L, m) - model.coriolis_torque(q, dq),
        "G": lambda q, dq: gravity_torque(q, L, m) - model.gravity_torque(q),
        "J": lambda q, dq: basic_jacobian(q, L) - model.tip_jacobian(q),
        "T": lambda q, dq: tip_transform(q, L) - model.tip_pose(q),
    }
    largest = dict.fromkeys(pairs, 0.0)
    positions = generator.uniform(-np.pi, np.pi, (samples, 3))
    velocities = generator.uniform(-1.0, 1.0, (samples, 3))
    for q, dq in zip(positions, velocities, strict=True):
        for name, difference in pairs.items():
            largest[name] = max(largest[name], float(np.abs(difference(q, dq)).max()))
    return largest
