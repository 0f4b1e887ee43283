"""Config of the joint measurement."""

from typing import Literal

from runner.config.per_stage import NonNegativePerStage
from runner.registry import StrictModel


class NoiseConfig(StrictModel):
    """Noise and steps of the joint encoders.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of the joint-position noise, in rad, by
            stage where the robot has several.
        distribution: Its shape; with none, `position` has no effect.
        resolution: Step to which the noisy joint positions are rounded, in rad, likewise; 0 for none.
        velocity: Whether joint velocities are exact or differences of the measured positions.
    """

    position: NonNegativePerStage
    distribution: Literal["uniform", "gaussian", "none"]
    resolution: NonNegativePerStage = 0.0
    velocity: Literal["exact", "finite_difference"]
