"""Stability limits of sampled force control in contact with a wall, also with delayed and missed commands."""

from typing import Protocol

import numpy as np

from runner.base.arrays import FloatArray


class ForceLaw(Protocol):
    """The gains of a law that pushes, as HybridForceConfig has them."""

    @property
    def force_gain(self) -> float:
        """Gain of the force's error."""
        ...

    @property
    def force_damping(self) -> float:
        """Damping ratio of the motion into the wall."""
        ...


def force_loop_radius(rate: float, force_gain: float, damping: float, delay: int = 0) -> float:
    r"""Return how a small motion in contact grows in a period: the spectral radius of the force loop's map.

    A mass on a wall of stiffness k under a push that is held for a period h and is d periods late,

    .. math:: m \ddot x = u - k x, \qquad u = -k k_f x - 2 \xi m \omega_c \dot x, \qquad
        \omega_c^2 = k (1 + k_f) / m,

    which is HybridForce about its rest, and Impedance with K_d for k k_f.

    Args:
        rate: omega_c h.
        force_gain: k_f; infinite is a position loop on no wall.
        damping: xi.
        delay: d.
    """
    wall = 0.0 if np.isinf(force_gain) else rate**2 / (1.0 + force_gain)  # k h^2 / m; the period is the unit of time
    return _radius(np.array([-wall, 0.0]), np.array([wall - rate**2, -2.0 * damping * rate]), delay)


def touch_radius(
    law: ForceLaw, mass: float, stiffness: float, drag: float, nominal_stiffness: float, period: float, delay: int
) -> float:
    """Return the same of a law on a damping wall that differs from its nominal one.

    Args:
        law: The law's gains.
        mass: Of the tip along the normal, in kg.
        stiffness: Of the wall, in N/m.
        drag: Its damping, in N s/m.
        nominal_stiffness: The law's nominal stiffness, in N/m.
        period: h, in s.
        delay: Periods from a push until it acts.
    """
    brake = 2.0 * law.force_damping * float(np.sqrt(nominal_stiffness * (1.0 + law.force_gain) * mass))
    wall = np.array([stiffness * period, drag]) * period / mass
    return _radius(-wall, -law.force_gain * wall - np.array([0.0, brake * period / mass]), delay)


def _radius(passive: FloatArray, gain: FloatArray, delay: int) -> float:
    """Return the spectral radius of a unit mass under passive . (x, v) and a held push gain . (x, v), a period long."""
    from scipy.linalg import expm  # for few configs

    step = expm(np.array([[0.0, 1.0, 0.0], [*passive, 1.0], [0.0, 0.0, 0.0]]))
    motion, push = step[:2, :2], step[:2, 2]
    goes: FloatArray = np.zeros((2 + delay, 2 + delay))  # position, velocity, and the pushes to come, the next first
    goes[:2, :2] = motion
    if delay:
        goes[:2, 2] = push
        goes[2:-1, 3:] = np.eye(delay - 1)
        goes[-1, :2] = gain
    else:
        goes += np.outer(push, gain)
    return float(np.abs(np.linalg.eigvals(goes)).max())


def force_loop_limit(force_gain: float, damping: float, delay: int = 0) -> float:
    """Return the largest omega_c h at which the loop of force_loop_radius is stable.

    The stiffest wall of a mass m at a period h is then k = m (omega_c h)^2 / (h^2 (1 + k_f)).
    """
    from scipy.optimize import brentq  # takes longer to import than a short run to simulate

    low = 1e-3
    high = low
    while force_loop_radius(high, force_gain, damping, delay) < 1.0:
        low, high = high, 1.05 * high
    return float(brentq(lambda rate: force_loop_radius(rate, force_gain, damping, delay) - 1.0, low, high))


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
    from scipy.optimize import brentq  # takes longer to import than a short run to simulate

    if miss_radius(rate, 0.0, damping) >= 1.0:
        return 0.0
    return float(brentq(lambda missed: miss_radius(rate, missed, damping) - 1.0, 0.0, 1.0 - 1e-9))


def _maps(rate: float, damping: float) -> tuple[FloatArray, FloatArray]:
    """Return the maps of a hit and of a miss, shapes (3, 3); the period is the unit of time."""
    miss = np.array([[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
    renewed = np.eye(3)
    renewed[2] = [-(rate**2), -2.0 * damping * rate, 0.0]
    return miss @ renewed, miss
