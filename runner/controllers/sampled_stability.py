"""Stability limit of sampled velocity loops, in closed form."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from runner.base.cache import Memory
from runner.controllers.controller import Loop
from runner.robots.robot import Robot
from runner.trajectories import Trajectory

_POSTURES = 9
_MEMORY = Memory(64)  # runs of a sweep have the same arm and path


class VelocityLoop(NamedTuple):
    """A sampled velocity loop relative to its stability limit.

    Attributes:
        share: h lambda_max(M^-1 K_v) / 2; above 1 the loop is unstable.
        coupling: lambda_max(M^-1 diag M) if K_v has a part proportional to diag M; else 1.
    """

    share: float
    coupling: float


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
