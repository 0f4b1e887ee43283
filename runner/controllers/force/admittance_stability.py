"""Contact stability of sampled admittance control with ideal joints.

With joint servos, the arm's mass and the servo stiffness also matter; see runner/plants/servo_contact_stability.py.
"""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.force.admittance_filter import AXES, Admittance, discretise


def contact_matrix(
    Phi: FloatArray, Gamma: FloatArray, period: float, stiffness: float, damping: float, delay: int
) -> FloatArray:
    r"""Return the transition matrix over one tick of an axis in contact with a wall.

    The arm reaches each command by the next tick, and the wall's force reaches the filter d ticks late:

    .. math:: f_k = -k x_{k-d} - c (x_{k-d} - x_{k-d-1}) / h

    Args:
        Phi: The axis' sampled law, shape (2, 2); see discretise.
        Gamma: The axis' sampled input, shape (2,).
        period: h, in s.
        stiffness: k of the wall, in N/m, or N m/rad.
        damping: c of the wall, in N s/m, or N m s/rad.
        delay: d, in ticks: 0 for an arm that follows exactly, more for delayed commands.

    Returns:
        Matrix of the state (dx_k, x_k, x_{k-1} ... x_{k-d-1}), shape (d + 3, d + 3).
    """
    (xx, xv), (vx, vv) = Phi
    xf, vf = Gamma
    matrix = np.zeros((delay + 3, delay + 3))
    matrix[0, :2], matrix[1, :2] = (vv, vx), (xv, xx)
    force = np.zeros(delay + 3)
    force[delay + 1], force[delay + 2] = -stiffness - damping / period, damping / period
    matrix[0] += vf * force
    matrix[1] += xf * force
    matrix[2:, 1:-1] = np.eye(delay + 1)
    return matrix


def spectral_radius(law: Admittance, period: float, axis: int, stiffness: float, damping: float, delay: int) -> float:
    """Return the spectral radius of the contact, which is stable below 1; see contact_matrix."""
    Phi, Gamma = discretise(law, period)
    return _radius(contact_matrix(Phi[axis], Gamma[axis], period, stiffness, damping, delay))


def stiffest_wall(law: Admittance, period: float, axis: int, damping: float, delay: int) -> float:
    """Return the wall stiffness up to which contact is stable, in N/m or N m/rad; see contact_matrix.

    0 if no wall is soft enough, as for an axis without damping.
    """
    from scipy.optimize import brentq  # takes longer to import than a run without a wall

    def excess(exponent: float) -> float:
        return _radius(contact_matrix(Phi[axis], Gamma[axis], period, 10.0**exponent, damping, delay)) - 1.0

    Phi, Gamma = discretise(law, period)
    middle = -float(np.log10(Gamma[axis, 0]))  # the wall's force reverses its displacement in one period
    exponents = np.linspace(middle - 8.0, middle + 3.0, 111)
    unstable = [excess(exponent) >= 0.0 for exponent in exponents]
    first = unstable.index(True)
    return 0.0 if first == 0 else float(10.0 ** brentq(excess, exponents[first - 1], exponents[first]))


def _radius(matrix: FloatArray) -> float:
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def check_wall(law: Admittance, period: float, stiffness: float, damping: float, delay: int) -> None:
    """Check that contact with a wall is stable along every axis of translation; see contact_matrix.

    Raises:
        ConfigError: if it is unstable along one; the message has the stiffness up to which it is stable.
    """
    problems = []
    for axis in range(3):
        radius = spectral_radius(law, period, axis, stiffness, damping, delay)
        if radius >= 1.0:
            bound = stiffest_wall(law, period, axis, damping, delay)
            problems.append(
                f"controller.period: at {period:g} s the admittance along {AXES[axis]} is unstable against a wall of "
                f"{stiffness:g} N/m (spectral radius {radius:.4g}); predicted bound: {bound:.4g} N/m. Take a softer "
                f"wall, a shorter period, or more controller.damping or controller.mass"
            )
    if problems:
        raise ConfigError(problems)
