"""How stiff a wall a sampled force law stands, by the map of one period."""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from runner.controllers.controller import FloatArray


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
    gain = np.array([wall - rate**2, -2.0 * damping * rate])
    step = expm(np.array([[0.0, 1.0, 0.0], [-wall, 0.0, 1.0], [0.0, 0.0, 0.0]]))
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
    low = 1e-3
    high = low
    while force_loop_radius(high, force_gain, damping, delay) < 1.0:
        low, high = high, 1.05 * high
    return float(brentq(lambda rate: force_loop_radius(rate, force_gain, damping, delay) - 1.0, low, high))
