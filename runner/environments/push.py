"""A wrench that comes and goes, steady or as a sine."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.environments.environment import Environment, FloatArray
from runner.registry import StrictModel

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class PushConfig(StrictModel):
    """Config of a push.

    Attributes:
        kind: Its name in the registry.
        force: Force on the tip along the base's axes, in N; the amplitude of a sine.
        moment: Moment about the tip along the base's axes, in N m; likewise.
        begin: When it sets in, in s.
        lasts: How long it lasts, in s; None is for ever.
        frequency: Of the sine, in Hz; 0 is a steady push.
    """

    kind: Literal["push"]
    force: Vector
    moment: Vector
    begin: NonNegativeFloat
    lasts: PositiveFloat | None
    frequency: NonNegativeFloat


class Push:
    """The push; see Environment."""

    def __init__(self, config: PushConfig) -> None:
        self._wrench = np.array([*config.force, *config.moment])
        self._begin = config.begin
        self._end = math.inf if config.lasts is None else config.begin + config.lasts
        self._rate = 2.0 * math.pi * config.frequency

    def reset(self, tip: FloatArray) -> None:
        """Do nothing: it depends on the time alone."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip; see Environment.wrench."""
        since = time - self._begin
        if since < -1e-9 or time > self._end - 1e-9:
            return np.zeros(6)
        return self._wrench * (math.sin(self._rate * since) if self._rate else 1.0)


CONFIG = PushConfig


def build(config: PushConfig) -> Environment:
    """Make the push that a config describes."""
    return Push(config)
