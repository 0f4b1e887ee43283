"""Temporary wrench on the tip or force on a link, constant or sinusoidal."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.environments.environment import Environment
from runner.schema.model import StrictModel
from runner.schema.units import Hertz, NewtonMetres, Newtons, Seconds

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class PushConfig(StrictModel):
    """Config of a push.

    Attributes:
        kind: Name of the kind in the registry.
        force: Force along the axes of the base, in N; the amplitude if frequency is above 0.
        moment: Moment about the tip along the axes of the base, in N m; the amplitude if frequency is above 0. It must
            be zero if a link is pushed.
        link: Link whose origin the force acts on; None is the tip.
        start_time: Start time of the push, in s.
        duration: Duration of the push, in s; None means until the end of the run.
        frequency: Frequency of a sinusoidal push, in Hz; 0 for a constant push.
    """

    kind: Literal["push"]
    force: Newtons[Vector]
    moment: NewtonMetres[Vector]
    link: str | None
    start_time: Seconds[NonNegativeFloat]
    duration: Seconds[PositiveFloat | None]
    frequency: Hertz[NonNegativeFloat]


class Push(Environment):
    """Push on the tip; see Environment."""

    def __init__(self, config: PushConfig) -> None:
        self._wrench = np.array([*config.force, *config.moment])
        self._start = config.start_time
        self._end = math.inf if config.duration is None else config.start_time + config.duration
        self._rate = 2.0 * math.pi * config.frequency

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip; see Environment.wrench."""
        return self._wrench * self.share(time)

    def share(self, time: float) -> float:
        """Return the factor of force and moment, from -1 to 1, at a time in s."""
        since = time - self._start
        if since < -1e-9 or time > self._end - 1e-9:
            return 0.0
        return math.sin(self._rate * since) if self._rate else 1.0


class PushOnLink(Environment):
    """Push on a link; see Environment."""

    def __init__(self, config: PushConfig, link: str) -> None:
        self._push, self._force = Push(config), np.array(config.force)
        self.points = {link: (0.0, 0.0, 0.0)}
        """Point of application in the link's frame, in m, by link."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return zero, because nothing acts on the tip; see Environment.wrench."""
        return np.zeros(6)

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the force on the link; see Environment.link_forces."""
        return self._push.share(time) * self._force[None]


CONFIG = PushConfig


def build(config: PushConfig) -> Environment:
    """Build the push that a config describes.

    Raises:
        ConfigError: if a moment acts on a link.
    """
    if config.link is None:
        return Push(config)
    if any(config.moment):
        raise ConfigError(
            f"environment.moment: {config.moment} acts on the tip alone; take [0, 0, 0] for a push on a link"
        )
    return PushOnLink(config, config.link)
