"""Flat compliant wall: spring, damper and dry friction along the surface."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, field_validator

from runner.base import portable
from runner.base.arrays import FloatArray
from runner.environments import Environment
from runner.schema.model import StrictModel
from runner.schema.units import Damping, Metres, Stiffness

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]

_LENGTH = 1e-6  # tolerance of the length of a unit vector


class WallConfig(StrictModel):
    """Config of a wall.

    Attributes:
        kind: Name of the kind in the registry.
        distance: Distance from the start of the tip to the wall, against the normal, in m; below 0 the tip starts
            inside the wall.
        normal: Unit vector out of the wall, along the axes of the base.
        stiffness: Stiffness of the wall, in N/m.
        damping: Damping of the wall, in N s/m.
        friction: Coulomb friction coefficient along the surface; 0 is a frictionless wall.
    """

    kind: Literal["wall"]
    distance: Metres[float]
    normal: Vector
    stiffness: Stiffness[PositiveFloat]
    damping: Damping[NonNegativeFloat]
    friction: NonNegativeFloat = 0.0

    @field_validator("normal")
    @classmethod
    def _have_unit_length(cls, normal: list[float]) -> list[float]:
        if not any(normal):
            raise ValueError("must not be zero")
        length = float(np.linalg.norm(normal))
        if abs(length - 1.0) > _LENGTH:
            unit = ", ".join(f"{value / length:.8g}" for value in normal)
            raise ValueError(f"must be a unit vector, and its length is {length:.7g}; take [{unit}]")
        return normal


class Wall(Environment):
    r"""Wall in point contact with the tip; see Environment.

    At a depth d > 0 the wall pushes the tip out with the force k d + c dd/dt, and never pulls. Friction is a spring and
    a damper with the same k and c along the surface, between the tip p and the point a where it sticks. This point
    slides if the force would exceed Coulomb's limit (Cundall and Strack, Geotechnique 29(1), 1979):

    .. math:: f_t = -k (p - a) - c v_t, \qquad |f_t| \le \mu f_n

    So a tip at rest stays at rest, and the compliance of the wall is the same in every direction.

    Attributes:
        config: Config of the wall.
        normal: Unit vector out of the wall, shape (3,).
        point: A point of the surface, shape (3,), in m; set by reset.
    """

    def __init__(self, config: WallConfig) -> None:
        self.config = config
        self.normal: FloatArray = portable.unit(np.array(config.normal))
        self.point = np.zeros(3)
        self._sticks_at: FloatArray | None = None

    def reset(self, tip: FloatArray) -> None:
        """Place the wall at its distance from the tip."""
        self.point = tip - self.config.distance * self.normal
        self._sticks_at = None

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the wrench on the tip; calls must be in the order of time; see Environment.wrench."""
        depth = float(portable.dot(self.point - tip, self.normal))
        if depth <= 0.0:
            self._sticks_at = None
            return np.zeros(6)
        force = self.config.stiffness * depth - self.config.damping * float(portable.dot(velocity, self.normal))
        push = max(force, 0.0) * self.normal
        if self.config.friction:
            push = push + self._friction(self.config.friction * max(force, 0.0), tip, velocity)
        return np.concatenate([push, np.zeros(3)])

    def _friction(self, limit: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the force along the surface, shape (3,), in N, and update the point where the tip sticks."""
        stiffness, n, dot = self.config.stiffness, self.normal, portable.dot
        place, drag = tip - dot(tip, n) * n, self.config.damping * (velocity - dot(velocity, n) * n)
        if self._sticks_at is None:
            self._sticks_at = place
        pull: FloatArray = stiffness * (self._sticks_at - place) - drag
        size = portable.norm(pull)
        if size > limit:
            pull *= limit / size
            self._sticks_at = place + (pull + drag) / stiffness
        return pull


CONFIG = WallConfig
build = Wall
