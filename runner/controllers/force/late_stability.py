"""Stability limits for delayed and missed torque commands."""

import numpy as np
from scipy.optimize import brentq

from runner.base.arrays import FloatArray
from runner.controllers.force.force_stability import force_loop_limit


def delay_limit(late: int) -> float:
    """Return the largest omega_n h of a critically damped position loop that is so many periods late: 1, 0.4262, ..."""
    return force_loop_limit(np.inf, 1.0, late)


def pattern_limit(missed: int) -> float:
    """Return the largest omega_n h where after each hit so many periods are missed: the law at a longer period."""
    return delay_limit(0) / (missed + 1)


def miss_radius(rate: float, missed: float, damping: float = 1.0) -> float:
    r"""Return how the mean square of a small motion grows in a period, where each is missed with a probability p.

    A unit mass has position, velocity and the acceleration that is held; in a period that is hit the law renews it, in
    one that is missed it stays:

    .. math:: \rho ((1 - p) H \otimes H + p S \otimes S)

    Args:
        rate: omega_n h.
        missed: p.
        damping: xi.
    """
    hit, miss = _maps(rate, damping)
    squares = (1.0 - missed) * np.kron(hit, hit) + missed * np.kron(miss, miss)
    return float(np.abs(np.linalg.eigvals(squares)).max())


def miss_limit(rate: float, damping: float = 1.0) -> float:
    """Return the largest probability of a miss that a loop bears in the mean square; 0 where it bears none."""
    if miss_radius(rate, 0.0, damping) >= 1.0:
        return 0.0
    return float(brentq(lambda missed: miss_radius(rate, missed, damping) - 1.0, 0.0, 1.0 - 1e-9))


def _maps(rate: float, damping: float) -> tuple[FloatArray, FloatArray]:
    """Return the maps of a hit and of a miss, shapes (3, 3); the period is the unit of time."""
    miss = np.array([[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
    renewed = np.eye(3)
    renewed[2] = [-(rate**2), -2.0 * damping * rate, 0.0]
    return miss @ renewed, miss
