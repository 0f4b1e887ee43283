"""Pose errors from the limited repeatability of an arm."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel


def joint_deviation(model: RobotModel, postures: FloatArray, repeatability: float) -> float:
    r"""Return the standard deviation of each joint, in rad, that scatters the tip by an arm's repeatability.

    Independent, equal joint errors scatter the tip by :math:`\sigma \|J_v\|_F` (root mean square); the repeatability
    is taken as the root mean square of that over some postures.

    Args:
        model: The arm; its tip is where the repeatability is given, the flange.
        postures: Rows of joint positions, shape (N, nq), in rad.
        repeatability: In m.
    """
    squares = [np.sum(model.tip_jacobian(q)[:3] ** 2) for q in postures]
    return float(repeatability / np.sqrt(np.mean(squares)))


def pose_covariances(model: RobotModel, postures: FloatArray, deviation: float) -> FloatArray:
    """Return the covariance of the tip's pose error at each posture, sigma^2 J J', shape (N, 6, 6).

    Args:
        model: The arm.
        postures: Rows of joint positions, shape (N, nq), in rad.
        deviation: sigma, standard deviation of each joint's error, in rad.

    Returns:
        In the base frame: error of the tip's position in m, then rotation vector of its orientation's error in rad.
    """
    jacobians = np.array([model.tip_jacobian(q) for q in postures])
    covariances: FloatArray = deviation**2 * jacobians @ jacobians.transpose(0, 2, 1)
    return covariances
