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
        kind: Its name in the registry.
        force: Force along the base's axes, in N; the amplitude of a sine.
        moment: Moment about the tip along the base's axes, in N m; likewise. 0 where a link is pushed.
        link: Link whose origin the force acts on; None is the tip.
        start_time: When it sets in, in s.
        duration: How long it lasts, in s; None is for ever.
        frequency: Of the sine, in Hz; 0 is a steady push.
    """

    kind: Literal["push"]
    force: Newtons[Vector]
    moment: NewtonMetres[Vector]
    link: str | None
    start_time: Seconds[NonNegativeFloat]
    duration: Seconds[PositiveFloat | None]
    frequency: Hertz[NonNegativeFloat]


class Push(Environment):
    """The push on the tip; see Environment."""

    def __init__(self, config: PushConfig) -> None:
        self._wrench = np.array([*config.force, *config.moment])
        self._start = config.start_time
        self._end = math.inf if config.duration is None else config.start_time + config.duration
        self._rate = 2.0 * math.pi * config.frequency

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip; see Environment.wrench."""
        return self._wrench * self.share(time)

    def share(self, time: float) -> float:
        """Return how much of the push acts at a time, in s."""
        since = time - self._start
        if since < -1e-9 or time > self._end - 1e-9:
            return 0.0
        return math.sin(self._rate * since) if self._rate else 1.0


class PushOnLink(Environment):
    """The push on a link; see Environment."""

    def __init__(self, config: PushConfig, link: str) -> None:
        self._push, self._force = Push(config), np.array(config.force)
        self.points = {link: (0.0, 0.0, 0.0)}
        """Where the force acts: a point in the link's frame, in m."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return that nothing acts on the tip; see Environment.wrench."""
        return np.zeros(6)

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the force on the link; see Environment."""
        return self._push.share(time) * self._force[None]


CONFIG = PushConfig


def build(config: PushConfig) -> Environment:
    """Make the push that a config describes.

    Raises:
        ConfigError: for a moment on a link.
    """
    if config.link is None:
        return Push(config)
    if any(config.moment):
        raise ConfigError(
            f"environment.moment: {config.moment} acts on the tip alone; take [0, 0, 0] for a push on a link"
        )
    return PushOnLink(config, config.link)
