"""Torques of the joints from motor currents: a constant that is known to a few percent, and steps."""

from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.plugin import StrictModel, units


class MotorCurrentConfig(StrictModel):
    """Config of torques from motor currents.

    Attributes:
        kind: Its name in the registry.
        constant: Assumed torque constant, relative to the true one.
        resolution: Step of the torque, in N m; 0 for none.
    """

    kind: Literal["motor_current"]
    constant: PositiveFloat
    resolution: units.NewtonMetres[NonNegativeFloat]


class MotorCurrent:
    """The sensors; see runner/sensing/__init__.py."""

    def __init__(self, config):
        self.config = config

    def read(self, tick, torque):
        reading, step = self.config.constant * torque, self.config.resolution
        return step * np.round(reading / step) if step else reading


CONFIG = MotorCurrentConfig


def build(config, joints, ticks, generator):
    return MotorCurrent(config)
