"""Wrench on the tip or force on a link: a step, a sine, an impulse and band-limited white noise."""

import math
from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.environments import Environment
from runner.schema.model import StrictModel
from runner.schema.units import Hertz, NewtonMetres, Newtons, NewtonSeconds, Seconds

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
        impulse: Impulse along the axes of the base, in N s, as a force over the first control step of the push.
        noise: Standard deviation of a random force along each axis of the base during the push, in N.
        bandwidth: Bandwidth of the random force, in Hz. The force keeps its value for 1/(2 bandwidth) s; None means one
            control step, so that it is white up to half the rate of control.
    """

    kind: Literal["push"]
    force: Newtons[Vector]
    moment: NewtonMetres[Vector]
    link: str | None
    start_time: Seconds[NonNegativeFloat]
    duration: Seconds[PositiveFloat | None]
    frequency: Hertz[NonNegativeFloat]
    impulse: NewtonSeconds[Vector]
    noise: Newtons[NonNegativeFloat]
    bandwidth: Hertz[PositiveFloat | None]


class Push(Environment):
    """Push on the tip; see Environment."""

    def __init__(self, config: PushConfig) -> None:
        self._config, self._wrench = config, np.array([*config.force, *config.moment])
        self._end = math.inf if config.duration is None else config.start_time + config.duration
        self._tick, self._hold, self._drawn, self._noise = 0.0, math.inf, -1, np.zeros(3)
        self._draw: Callable[[], FloatArray] = lambda: np.zeros(3)

    def begin(self, tick: float, generator: np.random.Generator) -> None:
        """Prepare the random force of a repetition; see Environment.begin."""
        config = self._config
        self._tick, self._draw = tick, lambda: generator.standard_normal(3)
        self._hold = tick if config.bandwidth is None else max(tick, 0.5 / config.bandwidth)
        self._drawn, self._noise = -1, np.zeros(3)

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip; see Environment.wrench."""
        config, since = self._config, time - self._config.start_time
        if since < -1e-9 or time > self._end - 1e-9:
            return np.zeros(6)
        wrench: FloatArray = self._wrench * (
            math.sin(2.0 * math.pi * config.frequency * since) if config.frequency else 1.0
        )
        if since < self._tick - 1e-9:
            wrench[:3] += np.array(config.impulse) / self._tick
        if config.noise:
            for _ in range(self._drawn, int(since / self._hold + 1e-9)):
                self._noise = config.noise * self._draw()
                self._drawn += 1
            wrench[:3] += self._noise
        return wrench


class PushOnLink(Environment):
    """Push on a link; see Environment."""

    def __init__(self, config: PushConfig, link: str) -> None:
        self._push = Push(config)
        self.points = {link: (0.0, 0.0, 0.0)}
        """Point of application in the link's frame, in m, by link."""

    def begin(self, tick: float, generator: np.random.Generator) -> None:
        """Prepare the random force of a repetition; see Environment.begin."""
        self._push.begin(tick, generator)

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return zero, because nothing acts on the tip; see Environment.wrench."""
        return np.zeros(6)

    def link_forces(self, time: float, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the force on the link; see Environment.link_forces."""
        return self._push.wrench(time, positions[0], velocities[0])[None, :3]


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
            f"environment.moment: {config.moment} acts only on the tip; take [0, 0, 0] for a push on a link"
        )
    return PushOnLink(config, config.link)
