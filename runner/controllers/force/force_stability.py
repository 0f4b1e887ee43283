"""Stability limits of sampled force control in contact with a wall, also with delayed and missed commands."""

from typing import Protocol

import numpy as np

from runner.base.arrays import FloatArray


class ForceLaw(Protocol):
    """Gains of a force law, as in HybridForceConfig."""

    @property
    def force_gain(self) -> float:
        """Gain of the force error."""
        ...

    @property
    def force_damping(self) -> float:
        """Damping ratio of the motion into the wall."""
        ...


def force_loop_radius(rate: float, force_gain: float, damping: float, delay: int = 0) -> float:
    r"""Return the spectral radius of the force loop over one period, in contact with a wall.

    A mass on a wall of stiffness k is pushed by u, constant over a period h and d periods late,

    .. math:: m \ddot x = u - k x, \qquad u = -k k_f x - 2 \xi m \omega_c \dot x, \qquad
        \omega_c^2 = k (1 + k_f) / m,

    which is HybridForce about its rest, and Impedance with K_d for k k_f.

    Args:
        rate: omega_c h.
        force_gain: k_f; infinite for a position loop without a wall.
        damping: xi.
        delay: d.
    """
    wall = 0.0 if np.isinf(force_gain) else rate**2 / (1.0 + force_gain)  # k h^2 / m; the period is the unit of time
    return _radius(np.array([-wall, 0.0]), np.array([wall - rate**2, -2.0 * damping * rate]), delay)


def touch_radius(
    law: ForceLaw, mass: float, stiffness: float, drag: float, nominal_stiffness: float, period: float, delay: int
) -> float:
    """Return the spectral radius of a force loop on a damping wall that differs from the nominal wall.

    Args:
        law: Gains of the law.
        mass: Mass of the tip along the normal, in kg.
        stiffness: Stiffness of the wall, in N/m.
        drag: Damping of the wall, in N s/m.
        nominal_stiffness: Wall stiffness in the law, in N/m.
        period: h, in s.
        delay: Delay of the push, in periods.
    """
    brake = 2.0 * law.force_damping * float(np.sqrt(nominal_stiffness * (1.0 + law.force_gain) * mass))
    wall = np.array([stiffness * period, drag]) * period / mass
    return _radius(-wall, -law.force_gain * wall - np.array([0.0, brake * period / mass]), delay)


def _radius(passive: FloatArray, gain: FloatArray, delay: int) -> float:
    """Return the spectral radius of a unit mass under passive . (x, v) and gain . (x, v), held for a unit period."""
    from scipy.linalg import expm  # only a few configs need it

    step = expm(np.array([[0.0, 1.0, 0.0], [*passive, 1.0], [0.0, 0.0, 0.0]]))
    motion, push = step[:2, :2], step[:2, 2]
    goes: FloatArray = np.zeros((2 + delay, 2 + delay))  # position, velocity, and the pending pushes, the next first
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
    """Return the largest stable omega_n h of a critically damped position loop with a delay in periods.

    It is 1 without a delay and 0.4262 for one period.
    """
    return force_loop_limit(np.inf, 1.0, late)


def pattern_limit(missed: int) -> float:
    """Return the largest stable omega_n h if so many periods are missed after each hit, which lengthens the period."""
    return delay_limit(0) / (missed + 1)


def miss_radius(rate: float, missed: float, damping: float = 1.0) -> float:
    r"""Return the growth of the mean square of a small motion per period, if each is missed with probability p.

    The state of a unit mass is position, velocity and commanded acceleration. A hit (H) updates the acceleration, a
    miss (S) keeps it:

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
    """Return the largest probability of a miss at which the mean square is stable; 0 if it never is."""
    from scipy.optimize import brentq  # takes longer to import than a short run to simulate

    if miss_radius(rate, 0.0, damping) >= 1.0:
        return 0.0
    return float(brentq(lambda missed: miss_radius(rate, missed, damping) - 1.0, 0.0, 1.0 - 1e-9))


def _maps(rate: float, damping: float) -> tuple[FloatArray, FloatArray]:
    """Return the state transitions of a hit and of a miss, shapes (3, 3); the period is the unit of time."""
    miss = np.array([[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
    renewed = np.eye(3)
    renewed[2] = [-(rate**2), -2.0 * damping * rate, 0.0]
    return miss @ renewed, miss
