"""Stability of sampled control loops: linear maps of one period, their spectral radii, and critical values.

Velocity loops, admittance control and force control in contact with a wall, and delayed or missed commands. With joint
servos, the arm's mass and the servo stiffness also matter in contact; see runner/caveats/servo_contact_stability.py.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import accumulate, repeat
from operator import mul
from typing import NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.memory import Memory
from runner.controllers.controller import Loop
from runner.controllers.force.admittance_filter import AXES, Admittance, discretise, held_map
from runner.robots.robot import Robot
from runner.trajectories import Trajectory

_POSTURES = 9
_MEMORY = Memory(64)  # runs of a sweep have the same arm and path


def spectral_radius(matrix: FloatArray) -> float:
    """Return the largest modulus of an eigenvalue; the loop is stable below 1."""
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def critical_value(
    radius: Callable[[float], float], values: Iterable[float], rounding: float = 0.0, xtol: float = 2e-12
) -> float:
    """Return the smallest value with a spectral radius of 1.

    The result is -inf if the radius is 1 or more at the first value, and inf if it is below 1 at all values.

    Args:
        radius: Spectral radius as a function of the value.
        values: Increasing values, so close that at most one crossing lies between two of them.
        rounding: Largest excess of the radius over 1 that still counts as stable.
        xtol: Absolute tolerance of the result.
    """
    from scipy.optimize import brentq  # takes longer to import than a short run to simulate

    below = -math.inf
    for value in values:
        if radius(value) - 1.0 >= rounding:
            first = math.isinf(below)
            return below if first else float(brentq(lambda at: radius(at) - 1.0, below, value, xtol=xtol))
        below = value
    return math.inf


class VelocityLoop(NamedTuple):
    """A sampled velocity loop relative to its stability limit."""

    share: float  # h lambda_max(M^-1 K_v) / 2; above 1 the loop is unstable
    coupling: float  # lambda_max(M^-1 diag M) if K_v has a part proportional to diag M; else 1


def velocity_loop(loops: Sequence[Loop], arm: Robot, path: Trajectory) -> VelocityLoop | None:
    r"""Return the loop of an arm that is nearest to its stability limit; None if no law has a known K_v.

    The mass matrix is taken at home and, for a desired joint motion, at nine configurations along it.

    Under tau = - K_v dq, constant over a period h, each period multiplies the velocity by 1 - h M^-1 K_v. This is
    stable for

    .. math:: h \lambda_\max(M^{-1} K_v) < 2

    Position gains with a damping ratio near 1 shift this bound by less than 5 % for the arms of robots/.

    Args:
        loops: The control loops.
        arm: The robot.
        path: The desired motion.
    """
    found: list[VelocityLoop] = []
    for loop in loops:
        gain = loop.controller.velocity_gain
        if gain is not None:
            coupling = _MEMORY.recall(_coupling, arm, path, gain.at_home) if gain.inertia else 1.0
            found.append(VelocityLoop(0.5 * loop.period * (gain.inertia * coupling + gain.mass), coupling))
    return max(found, default=None)


def _coupling(arm: Robot, path: Trajectory, at_home: bool) -> float:
    """Return the largest lambda_max(M^-1 D), with D = diag M at home or at each configuration."""
    moved = path.sample_joints(np.linspace(0.0, path.duration, _POSTURES))
    D, largest = arm.model.mass_matrix(arm.home).diagonal(), 0.0
    for q in (arm.home, *(() if moved is None else moved[:, 0])):
        M = arm.model.mass_matrix(q)
        scaled = np.linalg.solve(M, np.diag(D if at_home else M.diagonal()))
        largest = max(largest, float(np.linalg.eigvals(scaled).real.max()))
    return largest


def contact_matrix(
    Phi: FloatArray, Gamma: FloatArray, period: float, stiffness: float, damping: float, delay: int
) -> FloatArray:
    r"""Return the transition matrix over one tick of an axis in contact with a wall.

    The arm reaches each command by the next tick, and the wall's force reaches the filter d ticks late:

    .. math:: f_k = -k x_{k-d} - c (x_{k-d} - x_{k-d-1}) / h

    Args:
        Phi: Sampled law of the axis, shape (2, 2); see discretise.
        Gamma: Sampled input of the axis, shape (2,).
        period: h, in s.
        stiffness: k of the wall, in N/m, or N m/rad.
        damping: c of the wall, in N s/m, or N m s/rad.
        delay: d, in ticks: 0 for an arm that follows exactly, more for delayed commands.

    Returns:
        Matrix of the state (dx_k, x_k, x_{k-1} ... x_{k-d-1}), shape (d + 3, d + 3).
    """
    (xx, xv), (vx, vv) = Phi
    xf, vf = Gamma
    matrix = np.zeros((delay + 3, delay + 3))
    matrix[0, :2], matrix[1, :2] = (vv, vx), (xv, xx)
    force = np.zeros(delay + 3)
    force[delay + 1], force[delay + 2] = -stiffness - damping / period, damping / period
    matrix[0] += vf * force
    matrix[1] += xf * force
    matrix[2:, 1:-1] = np.eye(delay + 1)
    return matrix


def wall_radius(law: Admittance, period: float, axis: int, stiffness: float, damping: float, delay: int) -> float:
    """Return the spectral radius of an admittance in contact; see contact_matrix."""
    Phi, Gamma = discretise(law, period)
    return spectral_radius(contact_matrix(Phi[axis], Gamma[axis], period, stiffness, damping, delay))


def stiffest_wall(law: Admittance, period: float, axis: int, damping: float, delay: int) -> float:
    """Return the wall stiffness up to which contact is stable, in N/m or N m/rad; see contact_matrix.

    0 if no wall is soft enough, as for an axis without damping.
    """
    Phi, Gamma = discretise(law, period)

    def radius(exponent: float) -> float:
        return spectral_radius(contact_matrix(Phi[axis], Gamma[axis], period, 10.0**exponent, damping, delay))

    middle = -float(np.log10(Gamma[axis, 0]))  # the wall's force reverses its displacement in one period
    return float(10.0 ** critical_value(radius, np.linspace(middle - 8.0, middle + 3.0, 111).tolist()))


def check_wall(law: Admittance, period: float, stiffness: float, damping: float, delay: int) -> None:
    """Check that contact with a wall is stable along every axis of translation; see contact_matrix.

    Raises:
        ConfigError: if it is unstable along one; the message has the stiffness up to which it is stable.
    """
    problems = []
    for axis in range(3):
        radius = wall_radius(law, period, axis, stiffness, damping, delay)
        if radius >= 1.0:
            bound = stiffest_wall(law, period, axis, damping, delay)
            problems.append(
                f"controller.period: at {period:g} s the admittance along {AXES[axis]} is unstable against a wall of "
                f"{stiffness:g} N/m (spectral radius {radius:.4g}); predicted bound: {bound:.4g} N/m. Take a softer "
                f"wall, a shorter period, or more controller.damping or controller.mass"
            )
    if problems:
        raise ConfigError(problems)


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
    return _held_radius(np.array([-wall, 0.0]), np.array([wall - rate**2, -2.0 * damping * rate]), delay)


def touch_radius(
    gains: tuple[float, float],
    mass: float,
    stiffness: float,
    drag: float,
    nominal_stiffness: float,
    period: float,
    delay: int,
) -> float:
    """Return the spectral radius of a force loop on a damping wall that differs from the nominal wall.

    Args:
        gains: Gain of the force error and damping ratio of the motion into the wall, as in HybridForceConfig.
        mass: Mass of the tip along the normal, in kg.
        stiffness: Stiffness of the wall, in N/m.
        drag: Damping of the wall, in N s/m.
        nominal_stiffness: Wall stiffness in the law, in N/m.
        period: h, in s.
        delay: Delay of the push, in periods.
    """
    force_gain, damping = gains
    brake = 2.0 * damping * float(np.sqrt(nominal_stiffness * (1.0 + force_gain) * mass))
    wall = np.array([stiffness * period, drag]) * period / mass
    return _held_radius(-wall, -force_gain * wall - np.array([0.0, brake * period / mass]), delay)


def _held_radius(passive: FloatArray, gain: FloatArray, delay: int) -> float:
    """Return the spectral radius of a unit mass under passive . (x, v) and gain . (x, v), held for a unit period."""
    motion, push = held_map(np.array([[0.0, 1.0], passive]), np.array([[0.0], [1.0]]), 1.0)
    goes: FloatArray = np.zeros((2 + delay, 2 + delay))  # position, velocity, and the pending pushes, the next first
    goes[:2, :2] = motion
    if delay:
        goes[:2, 2] = push[:, 0]
        goes[2:-1, 3:] = np.eye(delay - 1)
        goes[-1, :2] = gain
    else:
        goes += push * gain
    return spectral_radius(goes)


def force_loop_limit(force_gain: float, damping: float, delay: int = 0) -> float:
    """Return the largest omega_c h at which the loop of force_loop_radius is stable.

    The stiffest wall of a mass m at a period h is then k = m (omega_c h)^2 / (h^2 (1 + k_f)).
    """
    rates = accumulate(repeat(1.05), mul, initial=1e-3)
    return critical_value(lambda rate: force_loop_radius(rate, force_gain, damping, delay), rates)


def delay_limit(late: int) -> float:
    """Return the largest stable omega_n h of a critically damped position loop with a delay in periods.

    It is 1 without a delay and 0.4262 for one period.
    """
    return force_loop_limit(np.inf, 1.0, late)


def pattern_limit(missed: int) -> float:
    """Return the largest stable omega_n h if `missed` periods are missed after each hit, which lengthens the period."""
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
    return spectral_radius(squares)


def miss_limit(rate: float, damping: float = 1.0) -> float:
    """Return the largest probability of a miss at which the mean square is stable; 0 if it never is."""
    return max(0.0, critical_value(lambda missed: miss_radius(rate, missed, damping), (0.0, 1.0 - 1e-9)))


def _maps(rate: float, damping: float) -> tuple[FloatArray, FloatArray]:
    """Return the state transitions of a hit and of a miss, shapes (3, 3); the period is the unit of time."""
    miss = np.array([[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
    renewed = np.eye(3)
    renewed[2] = [-(rate**2), -2.0 * damping * rate, 0.0]
    return miss @ renewed, miss
