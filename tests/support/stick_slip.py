"""A mass that a spring pulls, whose other end moves evenly: exact motion by events, and its period."""

import numpy as np
from scipy.integrate import solve_ivp
from support.friction import MASS

STIFFNESS, SPEED = 50.0, 0.1  # N m/rad, rad/s


def exact_period(level, static: float) -> float:
    """Return the period of the limit cycle, in s.

    Args:
        level: Function of the speed in motion, in rad/s; returns the friction, in N m.
        static: Friction up to which the mass rests, in N m.
    """

    def slope(t, state):
        x, v = state
        return v, (STIFFNESS * (static / STIFFNESS + SPEED * t - x) - level(v)) / MASS

    def stops(t, state):
        return state[1] if t > 1e-3 else 1.0

    stops.terminal, stops.direction = True, -1.0
    slip = solve_ivp(slope, (0.0, 100.0), (0.0, 0.0), events=stops, rtol=1e-10, atol=1e-12)
    (end,) = slip.t_events[0]
    force = static + STIFFNESS * (SPEED * end - slip.y[0, -1])
    assert -static < force < static
    return end + (static - force) / (STIFFNESS * SPEED)


def exact_coulomb_period(coulomb: float, static: float) -> float:
    """Return the period for a level that falls from static to coulomb at once, in closed form, in s."""
    omega = np.sqrt(STIFFNESS / MASS)
    drop = (static - coulomb) / (STIFFNESS * SPEED)  # s
    return 2.0 * drop + 2.0 * (np.pi - np.arctan(omega * drop)) / omega


def pulled(plant, tick: float, duration: float):
    """Return times and positions of a joint on the spring from rest, in s and rad."""
    plant.reset(np.zeros(1), np.zeros(1))
    t = tick * np.arange(round(duration / tick))
    q = np.empty(len(t))
    for k, now in enumerate(t):
        q[k] = plant.q[0]
        plant.advance(np.array([STIFFNESS * (SPEED * now - plant.q[0])]))
    return t, q


def period_of(t, q) -> float:
    """Return the mean time between two starts of slips except for the first, in s."""
    moves = np.abs(np.diff(q)) > 1e-9
    starts = t[1:-1][~moves[:-1] & moves[1:]]
    assert len(starts) > 3
    return float(np.diff(starts)[1:].mean())
