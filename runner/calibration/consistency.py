"""Consistency test of calibration errors and their covariances."""

from dataclasses import dataclass

import numpy as np
from scipy.special import gammaincinv

from runner.base.arrays import FloatArray


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
        """Whether the mean lies in the band: the covariances are neither too small nor too large."""
        return self.lower <= self.mean <= self.upper


def consistency(errors: FloatArray, covariances: FloatArray, level: float) -> Consistency:
    """Compare errors with the covariances that their calibrations gave.

    Over N repetitions of n parameters, N times the mean is chi-square with N n degrees of freedom. Single parameters
    "within three standard deviations" would fail by chance alone once there are a few hundred of them.

    Args:
        errors: Estimate minus truth of each repetition, shape (N, n).
        covariances: What each repetition gave as its covariance, shape (N, n, n).
        level: Probability of the band, such as 0.99, its two tails alike.
    """
    normalised = np.einsum("ij,ij->i", errors, np.linalg.solve(covariances, errors[..., None])[..., 0])
    freedom = errors.size
    lower, upper = 2.0 * gammaincinv(0.5 * freedom, [0.5 * (1.0 - level), 0.5 * (1.0 + level)]) / len(errors)
    return Consistency(float(normalised.mean()), float(lower), float(upper))
