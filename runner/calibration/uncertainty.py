"""Uncertainty of calibrations: pose errors of an arm by its repeatability, and consistency of covariances."""

from dataclasses import dataclass

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


@dataclass(frozen=True)
class Consistency:
    """Mean normalised estimation error squared of repeated calibrations, and the band in which chance keeps it.

    Attributes:
        mean: Mean of e' P^-1 e over the repetitions; its expectation is the number of parameters.
        lower: Lower end of the band.
        upper: Upper end of the band.
    """

    mean: float
    lower: float
    upper: float

    @property
    def holds(self) -> bool:
        """True if the mean lies in the band: the covariances are neither too small nor too large."""
        return self.lower <= self.mean <= self.upper


def consistency(errors: FloatArray, covariances: FloatArray, level: float) -> Consistency:
    """Compare errors with the covariances that their calibrations gave.

    Over N repetitions of n parameters, N times the mean is chi-square with N n degrees of freedom. Single parameters
    "within three standard deviations" would fail by chance if there are a few hundred of them.

    Args:
        errors: Estimate minus truth of each repetition, shape (N, n).
        covariances: What each repetition gave as its covariance, shape (N, n, n).
        level: Probability of the band, such as 0.99, its two tails alike.
    """
    from scipy.special import gammaincinv  # for few configs

    normalised = np.einsum("ij,ij->i", errors, np.linalg.solve(covariances, errors[..., None])[..., 0])
    freedom = errors.size
    lower, upper = 2.0 * gammaincinv(0.5 * freedom, [0.5 * (1.0 - level), 0.5 * (1.0 + level)]) / len(errors)
    return Consistency(float(normalised.mean()), float(lower), float(upper))
