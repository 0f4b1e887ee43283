"""Task-space directions of an arm: possible translations and rotations, and the effective mass of the tip."""

from functools import lru_cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel

_POSTURES = 20  # random ones, which together show every direction
_NONE = 1e-9  # of the largest singular value: a direction in which nothing moves


@lru_cache(maxsize=16)
def task_basis(model: RobotModel, pose: bool) -> FloatArray:
    """Return the directions, fixed in the base frame, in which joints can move an arm's tip from any of its postures.

    A spatial arm has all three, and the answer is the identity. The tip of an arm whose axes are parallel stays in a
    plane, and a task can ask for two; that of a SCARA turns about one axis alone, so that its pose has four.

    Args:
        model: The arm.
        pose: Whether the tip is to be turned, too.

    Returns:
        Unit directions, shape (k, 3): of the tip's velocity; for a pose, shape (k, 6), with those of its angular
        velocity below. A task's Jacobian is their product with the tip's.
    """
    lower, upper = model.usual_range
    postures = np.random.default_rng(0).uniform(lower, upper, (_POSTURES, model.nq))
    columns = np.hstack([model.tip_jacobian(q) for q in postures])
    linear = _span(columns[:3])
    directions = np.array(linear)
    if pose:
        from scipy.linalg import block_diag  # for few configs

        directions = block_diag(linear, _span(columns[3:]))
    directions.flags.writeable = False
    return directions


def distance_beside(model: RobotModel, points: FloatArray) -> FloatArray:
    """Return how far points, shape (N, 3), lie beside the plane or line that holds the tip, shape (N,), in m."""
    directions = task_basis(model, pose=False)
    if len(directions) == 3:
        return np.zeros(len(points))
    away = points - model.tip_position(np.mean(model.usual_range, axis=0))
    return np.asarray(np.linalg.norm(away - away @ directions.T @ directions, axis=1))


def _span(vectors: FloatArray) -> FloatArray:
    """Return unit vectors that span the columns of a matrix, shape (3, N) to (k, 3); along the axes where these do."""
    left, sizes, _ = np.linalg.svd(vectors, full_matrices=False)
    basis = left[:, sizes > max(_NONE * sizes[0], 1e-12)]
    axes = np.eye(3)[np.linalg.norm(basis, axis=1) > 1e-6]
    return axes if len(axes) == basis.shape[1] else np.asarray(basis.T)


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
