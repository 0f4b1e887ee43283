"""Task-space directions of an arm: possible translations and rotations, and the effective mass of the tip."""

from functools import lru_cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel

_POSTURES = 20  # random configurations, which together span every direction
_NONE = 1e-9  # of the largest singular value, for a direction without motion


@lru_cache(maxsize=16)
def task_basis(model: RobotModel, pose: bool) -> FloatArray:
    """Return the directions in the base frame in which the joints can move the tip of an arm in any configuration.

    For a spatial arm, the result is the identity. The tip of an arm with parallel axes stays in a plane, so a task has
    two directions. The tip of a SCARA rotates about one axis only, so its pose has four directions.

    Args:
        model: The arm.
        pose: True to include rotations of the tip.

    Returns:
        Unit directions of the tip velocity, shape (k, 3); for a pose, shape (k, 6), followed by those of the angular
        velocity. The Jacobian of a task is their product with the Jacobian of the tip.
    """
    lower, upper = model.usual_range
    postures = np.random.default_rng(0).uniform(lower, upper, (_POSTURES, model.nq))
    columns = np.hstack([model.tip_jacobian(q) for q in postures])
    linear = _span(columns[:3])
    directions = np.array(linear)
    if pose:
        angular = _span(columns[3:])
        directions = np.zeros((len(linear) + len(angular), 6))  # scipy's block_diag takes 0.3 s to import
        directions[: len(linear), :3], directions[len(linear) :, 3:] = linear, angular
    directions.flags.writeable = False
    return directions


def distance_beside(model: RobotModel, points: FloatArray) -> FloatArray:
    """Return the distance of points, shape (N, 3), from the plane or line of the tip, shape (N,), in m."""
    directions = task_basis(model, pose=False)
    if len(directions) == 3:
        return np.zeros(len(points))
    away = points - model.tip_position(np.mean(model.usual_range, axis=0))
    return np.asarray(np.linalg.norm(away - away @ directions.T @ directions, axis=1))


def _span(vectors: FloatArray) -> FloatArray:
    """Return unit vectors that span the columns of a matrix, shape (3, N) to (k, 3); along the axes if possible."""
    left, sizes, _ = np.linalg.svd(vectors, full_matrices=False)
    basis = left[:, sizes > max(_NONE * sizes[0], 1e-12)]
    axes = np.eye(3)[np.linalg.norm(basis, axis=1) > 1e-6]
    return axes if len(axes) == basis.shape[1] else np.asarray(basis.T)


def tip_mobility(model: RobotModel, q: FloatArray, first: int = 0) -> FloatArray:
    r"""Return the mobility of the tip when the joints from `first` on move, shape (3, 3), in 1/kg.

    .. math:: \Lambda^{-1} = J M^{-1} J^T

    J has the columns, and M the rows and columns, of the moving joints; this block of M is the mass matrix of the outer
    stages on a base at rest. The mobility is along the base axes of the robot, so mobilities of several stages can be
    compared. Each additional stage increases it by a positive semi-definite matrix (Khatib, International Journal of
    Robotics Research 14(1), 1995).

    Args:
        model: The whole arm.
        q: Joint positions, shape (nq,), in rad.
        first: Index of the first moving joint, such as that of a stage.
    """
    J, M = model.tip_jacobian(q)[:3, first:], model.mass_matrix(q)[first:, first:]
    return np.asarray(J @ np.linalg.solve(M, J.T))


def mass_along(mobility: FloatArray, direction: FloatArray) -> float:
    """Return the effective mass of a tip along a unit vector n, shape (3,), in kg: 1 / (n^T Lambda^-1 n)."""
    return 1.0 / float(direction @ mobility @ direction)
