"""Human guidance of the tip through a spring and a damper."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.environments.environment import Environment
from runner.schema.model import StrictModel
from runner.schema.units import Damping, Metres, Seconds, Stiffness
from runner.trajectories.blend import quintic_blend


class HandConfig(StrictModel):
    """Config of a hand.

    Attributes:
        kind: Its name in the registry.
        displacement: Where it leads the tip, from where the tip starts, along the base's axes, in m.
        start_time: When it sets out, in s.
        duration: How long it takes, from rest to rest, in s; then it holds still.
        stiffness: Of its grip, in N/m.
        damping: Of its grip, in N s/m.
    """

    kind: Literal["hand_guiding"]
    displacement: Metres[Annotated[list[float], Field(min_length=3, max_length=3)]]
    start_time: Seconds[NonNegativeFloat]
    duration: Seconds[PositiveFloat]
    stiffness: Stiffness[PositiveFloat]
    damping: Damping[NonNegativeFloat]


class Hand(Environment):
    """The hand; see Environment. It moves as the rest-to-rest quintic does, and turns nothing."""

    def __init__(self, config: HandConfig) -> None:
        self._config = config
        self._displacement = np.array(config.displacement)
        self._origin = np.zeros(3)

    def reset(self, tip: FloatArray) -> None:
        """Take hold of the tip where it is."""
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
