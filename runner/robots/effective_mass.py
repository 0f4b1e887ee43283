"""The mass that a tip has in each direction, of a whole arm and of the stages that ride on it."""

import numpy as np

from runner.robots.model import FloatArray
from runner.robots.robot import Robot


def tip_mobility(robot: Robot, q: FloatArray, stage: int = 0) -> FloatArray:
    r"""Return how the tip yields to a force when a stage and all after it move, shape (3, 3), in 1/kg.

    .. math:: \Lambda^{-1} = J M^{-1} J^T

    by the columns of the tip's J, and rows and columns of M, of the joints that move: M of a chain's outer joints is
    that of these arms on a base at rest. It is along the robot's base axes, whatever way their base is turned, so that
    mobilities of several stages may be compared: each stage more yields more (Khatib, International Journal of Robotics
    Research 14(1), 1995), the difference to the next one is positive semi-definite.

    Args:
        robot: The robot.
        q: Joint positions of all stages, shape (nq,), in rad.
        stage: Index of the first stage that moves.
    """
    first = robot.stages[stage].joints.start
    J, M = robot.model.tip_jacobian(q)[:3, first:], robot.model.mass_matrix(q)[first:, first:]
    return np.asarray(J @ np.linalg.solve(M, J.T))


def mass_along(mobility: FloatArray, direction: FloatArray) -> float:
    """Return the mass that a tip has along a unit vector, shape (3,), in kg: 1 / (n^T Lambda^-1 n)."""
    return 1.0 / float(direction @ mobility @ direction)
