"""Encoders behind a gear with backlash: they follow once the play is used up, and count in steps."""

from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.plugin import StrictModel, units


class BacklashConfig(StrictModel):
    """Config of encoders with backlash.

    Attributes:
        kind: Its name in the registry.
        play: Whole width of the play, in rad.
        resolution: Step of the encoders, in rad.
        noise: Standard deviation of the position before it is rounded, in rad.
    """

    kind: Literal["backlash"]
    play: units.Radians[NonNegativeFloat]
    resolution: units.Radians[PositiveFloat]
    noise: units.Radians[NonNegativeFloat]


class Backlash:
    """The encoders of one control loop; see runner/sensing/__init__.py."""

    def __init__(self, config, joints, ticks, period, generator):
        self.config, self.period = config, period
        self.errors = config.noise * generator.standard_normal((ticks, len(joints)))
        self.behind = self.last = None

    def measure(self, tick, q, dq):
        half, step = 0.5 * self.config.play, self.config.resolution
        self.behind = q.copy() if self.behind is None else np.clip(self.behind, q - half, q + half)
        measured = step * np.round((self.behind + self.errors[tick]) / step)
        velocity = np.zeros(len(q)) if self.last is None else (measured - self.last) / self.period
        self.last = measured
        return measured, velocity


CONFIG = BacklashConfig


def build(config, joints, ticks, period, generator):
    return Backlash(config, joints, ticks, period, generator)
