"""A flat wall that gives way as a spring and a damper do."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, field_validator

from runner.environments.environment import Environment, FloatArray
from runner.registry import StrictModel

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class WallConfig(StrictModel):
    """Config of a wall.

    Attributes:
        kind: Its name in the registry.
        distance: From the tip at its start to the wall, against the normal, in m; below 0 it stands in the wall.
        normal: Out of the wall, along the base's axes; its length has no influence.
        stiffness: In N/m.
        damping: In N s/m.
    """

    kind: Literal["wall"]
    distance: float
    normal: Vector
    stiffness: PositiveFloat
    damping: NonNegativeFloat

    @field_validator("normal")
    @classmethod
    def _point_somewhere(cls, normal: list[float]) -> list[float]:
        if not any(normal):
            raise ValueError("must not be zero")
        return normal


class Wall:
    """The wall, frictionless, felt by the tip as a point; see Environment.

    Attributes:
        config: Its numbers.
        normal: Unit vector out of it, shape (3,).
        point: A point of its face, shape (3,), in m; set by reset.
    """

    def __init__(self, config: WallConfig) -> None:
        self.config = config
        self.normal: FloatArray = np.array(config.normal) / np.linalg.norm(config.normal)
        self.point = np.zeros(3)

    def reset(self, tip: FloatArray) -> None:
        """Stand at its distance from the tip."""
        self.point = tip - self.config.distance * self.normal

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip, k d + c dd for a depth d > 0, never a pull; see Environment.wrench."""
        depth = float((self.point - tip) @ self.normal)
        if depth <= 0.0:
            return np.zeros(6)
        force = self.config.stiffness * depth - self.config.damping * float(velocity @ self.normal)
        return np.concatenate([max(force, 0.0) * self.normal, np.zeros(3)])


CONFIG = WallConfig


def build(config: WallConfig) -> Environment:
    """Make the wall that a config describes."""
    return Wall(config)
