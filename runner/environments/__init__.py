"""Environments: external forces, walls and human guidance at the tip, and plug-in loads on links and joints."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.plugins.guard import Asked, Attribute, Guard, Method, array, find_fault, like, refuse
from runner.plugins.registry import KindConfig, Registry


class Environment:
    """Base class of environments. An environment must define `reset` and `wrench`; the other members have defaults.

    Attributes:
        points: Points of links on which the environment exerts forces, in addition to the tip: for the name of each
            link, a point in the link's frame, in m. The runner reads them once, before the run.
    """

    points: Mapping[str, Sequence[float]] = {}

    def begin(self, tick: float, generator: np.random.Generator) -> None:
        """Prepare for a repetition, before `reset`.

        Args:
            tick: Time between two updates, in s.
            generator: Generator of the random numbers of the environment, which follows from seed and repetition.
        """

    def reset(self, tip: FloatArray) -> None:
        """Reset the environment at the start of a run, with the tip position in the base frame, shape (3,), in m."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip.

        Args:
            time: Time since the start, in s.
            tip: Tip position in the base frame, shape (3,), in m.
            velocity: Linear velocity of the tip, shape (3,), in m/s.

        Returns:
            Force in N and moment about the tip in N m, along the axes of the base, shape (6,).
        """
        raise NotImplementedError

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the forces at `points`.

        Args:
            time: Time since the start, in s.
            positions: Positions of the points in the base frame, in the order of `points`, shape (n, 3), in m.
            velocities: Velocities of the points, shape (n, 3), in m/s.

        Returns:
            Forces in N along the axes of the base, shape (n, 3).
        """
        raise NotImplementedError

    def joint_torques(self, time: float, q: FloatArray, dq: FloatArray) -> FloatArray | None:
        """Return torques on the joints, such as those of a cable or a torsion spring, or None.

        Args:
            time: Time since the start, in s.
            q: True joint positions, shape (nq,), in rad; m for prismatic joints.
            dq: True joint velocities, shape (nq,), in rad/s; m/s for prismatic joints.

        Returns:
            Shape (nq,), in N m; N for prismatic joints.
        """
        return None


def _check_points(points: Any, _: Asked) -> dict[str, FloatArray]:
    found = dict(points)
    for link, point in found.items():
        if fault := find_fault(point, (3,)):
            raise ConfigError(f"environment.kind: its point on {quoted(link)} is {fault}")
    return {str(link): np.array(point, dtype=np.float64) for link, point in found.items()}


_GUARD = Guard(
    "environment",
    Environment,
    begin=Method(optional=True),
    reset=Method(),
    wrench=Method(array(6)),
    points=Attribute(_check_points, optional=True, fail=refuse),
    link_forces=Method(like(1), optional=True),
    joint_torques=Method(like(1), optional=True),
)

ENVIRONMENTS = Registry[KindConfig, [], Environment | None](
    "environment",
    {
        "free": "runner.environments.free",
        "hand_guiding": "runner.environments.hand",
        "push": "runner.environments.push",
        "wall": "runner.environments.wall",
    },
    _GUARD,
)

__all__ = ["ENVIRONMENTS", "Environment"]
