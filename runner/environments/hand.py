"""Human guidance of the tip through a spring and a damper."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.environments import Environment
from runner.schema.model import StrictModel
from runner.schema.units import Damping, Metres, Seconds, Stiffness
from runner.trajectories.motion import quintic_blend


class HandConfig(StrictModel):
    """Config of human guidance.

    Attributes:
        kind: Name of the kind in the registry.
        displacement: Displacement of the hand from the start position of the tip, along the axes of the base, in m.
        start_time: Start time of the hand's motion, in s.
        duration: Duration of the hand's motion from rest to rest, in s; the hand then holds its position.
        stiffness: Stiffness of the grip, in N/m.
        damping: Damping of the grip, in N s/m.
    """

    kind: Literal["hand_guiding"]
    displacement: Metres[Annotated[list[float], Field(min_length=3, max_length=3)]]
    start_time: Seconds[NonNegativeFloat]
    duration: Seconds[PositiveFloat]
    stiffness: Stiffness[PositiveFloat]
    damping: Damping[NonNegativeFloat]


class Hand(Environment):
    """Hand that moves along a rest-to-rest quintic and exerts no moment; see Environment."""

    def __init__(self, config: HandConfig) -> None:
        self._config = config
        self._displacement = np.array(config.displacement)
        self._origin = np.zeros(3)

    def reset(self, tip: FloatArray) -> None:
        """Grip the tip at its start position."""
        self._origin = tip.copy()

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip; see Environment.wrench."""
        config = self._config
        share, speed, _ = quintic_blend(np.array([(time - config.start_time) / config.duration]))
        pull = config.stiffness * (self._origin + share * self._displacement - tip)
        pull += config.damping * (speed / config.duration * self._displacement - velocity)
        return np.concatenate([pull, np.zeros(3)])


CONFIG = HandConfig
build = Hand
