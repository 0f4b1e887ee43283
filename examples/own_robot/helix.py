"""A screw line upwards, from rest to rest."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field, PositiveFloat, PositiveInt

from runner.plugin import StrictModel, distance_to_curve, quintic_blend


class HelixConfig(StrictModel):
    """Keys of trajectory/helix.yaml: start, radius and height in m, duration in s."""

    kind: Literal["helix"]
    start: list[float] | None = Field(min_length=3, max_length=3)
    radius: PositiveFloat
    height: float
    turns: PositiveInt
    duration: PositiveFloat


@dataclass(frozen=True)
class Helix:
    """c(u) = start + (r (cos phi - 1), r sin phi, h u) with phi = 2 pi turns u, and u(t) the quintic from 0 to 1."""

    start: np.ndarray
    radius: float
    height: float
    turns: int
    duration: float
    tracked: bool = True

    @property
    def goal(self):
        return self.start + np.array([0.0, 0.0, self.height])

    @property
    def run_duration(self):
        return self.duration + 1.0  # a second more, so that the rest is seen

    def curve(self, u):
        """Return the point and its first two derivatives in u, shape (T, 3, 3)."""
        w, r = 2.0 * np.pi * self.turns, self.radius
        c, s, one = np.cos(w * u), np.sin(w * u), np.ones_like(u)
        place = self.start + np.stack([r * (c - 1.0), r * s, self.height * u], axis=1)
        first = np.stack([-r * w * s, r * w * c, self.height * one], axis=1)
        second = np.stack([-r * w**2 * c, -r * w**2 * s, 0.0 * one], axis=1)
        return np.stack([place, first, second], axis=1)

    def sample(self, times):
        u, du, ddu = quintic_blend(times / self.duration)
        du, ddu = du[:, None] / self.duration, ddu[:, None] / self.duration**2
        c = self.curve(u)
        return np.stack([c[:, 0], c[:, 1] * du, c[:, 2] * du**2 + c[:, 1] * ddu], axis=1)

    def distance_to_path(self, points):
        return distance_to_curve(points, self.curve, np.linspace(0.0, 1.0, 100 * self.turns + 1))


CONFIG = HelixConfig


def build(config, start):
    return Helix(start, config.radius, config.height, config.turns, config.duration)
