"""Runtime checks of environment plug-ins."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.plugins.guard.faults import ask, checked, find_fault, told_of_part
from runner.plugins.guard.read_only import read_only


class WatchedEnvironment:
    """An environment of the user's that ends the run as a failure where it raises, or gives no finite wrench.

    Args:
        environment: What is watched.
    """

    def __init__(self, environment: Any) -> None:
        self._environment = environment

    def reset(self, tip: FloatArray) -> None:
        """Reset it; see Environment."""
        ask(self._environment.reset, 0.0, read_only(tip))

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return its wrench; see Environment."""
        law = self._environment.wrench
        return checked(ask(law, time, time, read_only(tip), read_only(velocity)), (6,), law, time)


class WatchedPushes(WatchedEnvironment):
    """An environment of the user's that pushes links; see PushesLinks."""

    @property
    def points(self) -> Mapping[str, FloatArray]:
        """Its points.

        Raises:
            ConfigError: where they are no points by the names of links.
        """
        try:
            points = dict(self._environment.points)
        except Exception as error:
            raise ConfigError([f"environment.kind: its points: {told_of_part(error)}"]) from error
        for link, point in points.items():
            fault = find_fault(point, (3,))
            if fault:
                raise ConfigError([f"environment.kind: its point on {quoted(link)} is {fault}"])
        return {str(link): np.array(point, dtype=np.float64) for link, point in points.items()}

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return its forces; see PushesLinks."""
        law = self._environment.link_forces
        handed = (time, read_only(positions), read_only(velocities))
        return checked(ask(law, time, *handed), positions.shape, law, time)


class WatchedLoads(WatchedEnvironment):
    """An environment of the user's that loads joints; see LoadsJoints."""

    def joint_torques(self, time: float, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return its torques; see LoadsJoints."""
        law = self._environment.joint_torques
        return checked(ask(law, time, time, read_only(q), read_only(dq)), q.shape, law, time)


class WatchedPushesAndLoads(WatchedPushes, WatchedLoads):
    """An environment of the user's that does both."""


def watch_environment(environment: Any, *_: object) -> WatchedEnvironment:
    """Return an environment of the user's watched, with all that it offers."""
    from runner.environments.environment import LoadsJoints, PushesLinks

    pushes, loads = isinstance(environment, PushesLinks), isinstance(environment, LoadsJoints)
    if pushes:
        return (WatchedPushesAndLoads if loads else WatchedPushes)(environment)
    return (WatchedLoads if loads else WatchedEnvironment)(environment)
