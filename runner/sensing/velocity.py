r"""Joint velocity estimates from measured positions, for floats or any other scalar type.

`finite_difference` is d_k = (q_k - q_{k-1}) / h. `low_pass` passes d_k through a first-order filter of bandwidth w:

.. math:: v_k = v_{k-1} + a (d_k - v_{k-1}), \quad a = 1 - e^{-w h}, \qquad
    \frac{V}{Q} = \frac{a}{h} \frac{1 - z^{-1}}{1 - (1 - a) z^{-1}}

`luenberger` is the observer of a joint with constant velocity (Luenberger, IEEE Transactions on Military Electronics
8(2), 1964). Both poles are at p = e^{-w h}, so the bandwidth w is the only gain:

.. math:: e_k = q_k - \hat q_{k-1} - h \hat v_{k-1}, \quad \hat q_k = q_k - p^2 e_k, \quad
    \hat v_k = \hat v_{k-1} + \frac{(1 - p)^2}{h} e_k, \qquad \frac{V}{Q} = \frac{(1 - p)^2}{h}
    \frac{1 - z^{-1}}{(1 - p z^{-1})^2}

All three converge to the exact value of a constant velocity. Under a constant acceleration A they lag by A times h/2,
h/2 + h (1 - a)/a, and h/2 + 2 h p/(1 - p), respectively. A lower bandwidth reduces the noise from the positions.
"""

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

Velocity = Literal["exact", "finite_difference", "low_pass", "luenberger"]
"""Source of joint velocities: exact, or one of the methods above."""

DEFAULT_BANDWIDTH = 200.0
"""Default bandwidth of low_pass and luenberger, in rad/s."""

State = list[Any]
"""State of a method between ticks: arrays of shape (nq,)."""


def gains(way: Velocity, bandwidth: float, h: float) -> tuple[float, ...]:
    """Return the gains of a method from its bandwidth, in rad/s, and the time between two measurements, in s."""
    if way == "low_pass":
        return (-math.expm1(-bandwidth * h),)
    if way == "luenberger":
        p = math.exp(-bandwidth * h)
        return (p * p, math.expm1(-bandwidth * h) ** 2)
    return ()


def first_state(way: Velocity, measured: Any) -> State:
    """Return the state before the first measurement, shape (nq,), for an arm at rest; empty for exact velocities."""
    if way == "exact":
        return []
    return [measured] if way == "finite_difference" else [measured, np.zeros_like(measured)]


def next_velocity(way: Velocity, numbers: Sequence[Any], h: Any, measured: Any, state: State) -> tuple[Any, State]:
    """Return the estimated velocity after a measurement, shape (nq,), and the new state; not for exact velocities."""
    if way == "luenberger":
        p_squared, gain = numbers
        error = measured - state[0] - h * state[1]
        velocity = state[1] + gain / h * error
        return velocity, [measured - p_squared * error, velocity]
    difference = (measured - state[0]) / h
    if way == "finite_difference":
        return difference, [measured]
    velocity = state[1] + numbers[0] * (difference - state[1])
    return velocity, [measured, velocity]
