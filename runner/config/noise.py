"""Config of the joint measurement."""

from typing import Literal

from runner.config.per_stage import NonNegativePerStage
from runner.registry import StrictModel


class NoiseConfig(StrictModel):
    """Noise of the joint encoders.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of the joint-position noise, in rad, by
            stage where the robot has several.
        distribution: Its shape; with none, `position` has no effect.
        velocity: Whether joint velocities are exact or differences of the measured positions.
    """

    position: NonNegativePerStage
    distribution: Literal["uniform", "gaussian", "none"]
    velocity: Literal["exact", "finite_difference"]
