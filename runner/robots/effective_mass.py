"""Effective mass of the tip in each direction, for a whole arm and for its mounted stages."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel


def tip_mobility(model: RobotModel, q: FloatArray, first: int = 0) -> FloatArray:
    r"""Return how the tip yields to a force when joints from one on move, shape (3, 3), in 1/kg.

    .. math:: \Lambda^{-1} = J M^{-1} J^T

    by the columns of the tip's J, and rows and columns of M, of the joints that move: M of a chain's outer joints is
    that of these arms on a base at rest. It is along the robot's base axes, whatever way their base is turned, so that
    mobilities of several stages may be compared: each stage more yields more (Khatib, International Journal of Robotics
    Research 14(1), 1995), the difference to the next one is positive semi-definite.

    Args:
        model: The whole arm.
        q: Its joint positions, shape (nq,), in rad.
        first: The first joint that moves, such as that of a stage.
    """
    J, M = model.tip_jacobian(q)[:3, first:], model.mass_matrix(q)[first:, first:]
    return np.asarray(J @ np.linalg.solve(M, J.T))


def mass_along(mobility: FloatArray, direction: FloatArray) -> float:
    """Return the mass that a tip has along a unit vector, shape (3,), in kg: 1 / (n^T Lambda^-1 n)."""
    return 1.0 / float(direction @ mobility @ direction)
