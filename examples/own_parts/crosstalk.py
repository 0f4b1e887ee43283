"""A force/torque sensor whose axes see part of each other."""

from typing import Literal

import numpy as np
from pydantic import FiniteFloat, NonNegativeFloat

from runner.plugin import StrictModel


class CrosstalkConfig(StrictModel):
    """Config of a force/torque sensor with crosstalk.

    Attributes:
        kind: Its name in the registry.
        share: What every force sees of each other force, and every moment of each other moment.
        noise: Standard deviation of each reading, in N and N m.
    """

    kind: Literal["crosstalk"]
    share: FiniteFloat
    noise: NonNegativeFloat


class Crosstalk:
    """The sensor; see runner/sensing/__init__.py."""

    def __init__(self, config, ticks, generator):
        mixed = np.full((3, 3), config.share) + (1.0 - config.share) * np.eye(3)
        self.mixed = np.kron(np.eye(2), mixed)
        self.errors = config.noise * generator.standard_normal((ticks, 6))

    def read(self, tick, wrench):
        return self.mixed @ wrench + self.errors[tick]


CONFIG = CrosstalkConfig


def build(config, ticks, period, generator):
    return Crosstalk(config, ticks, generator)
