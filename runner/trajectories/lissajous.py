"""Lissajous figure: a sinusoid along each axis, with integer frequency ratios."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Radians, Seconds
from runner.trajectories.geometry import Point, distance_to_curve
from runner.trajectories.motion import ClosedCurve, Easing, PathMotion
from runner.trajectories.trajectory import Trajectory

_SAMPLES = 64  # per sine of the highest frequency, from which the nearest point is refined


class LissajousConfig(StrictModel):
    """Config of a Lissajous figure, along the x, y and z axes of the base frame.

    Attributes:
        kind: Name of the kind in the registry.
        start: Tip position at t = 0, in m; None is the tip at the home configuration.
        amplitudes: Half the extent of the figure along each axis, in m.
        frequencies: Number of sine periods along each axis in one figure, at most 100.
        phases: Phase of each sine at t = 0, in rad.
        easing: "quintic" for one figure from rest to rest, "none" for a periodic motion with constant phase rate.
        duration: Time of one figure, in s.
    """

    kind: Literal["lissajous"]
    start: Metres[Point | None]
    amplitudes: Metres[Annotated[list[NonNegativeFloat], Field(min_length=3, max_length=3)]]
    frequencies: Annotated[list[Annotated[int, Field(ge=0, le=100)]], Field(min_length=3, max_length=3)]
    phases: Radians[Point]
    easing: Easing
    duration: Seconds[PositiveFloat]

    @field_validator("amplitudes")
    @classmethod
    def _check_size(cls, value: list[float]) -> list[float]:
        if not any(value):
            raise ValueError("must be above 0 along one axis at least")
        return value

    @field_validator("frequencies")
    @classmethod
    def _check_frequencies(cls, value: list[int], info: ValidationInfo) -> list[int]:
        amplitudes = info.data.get("amplitudes", [])
        for axis, amplitude, frequency in zip("xyz", amplitudes, value, strict=False):
            if amplitude > 0.0 and frequency == 0:
                raise ValueError(f"must be 1 or more along {axis}, where the amplitude is {amplitude:g} m")
        return value


@dataclass(frozen=True)
class Lissajous(ClosedCurve):
    r"""A Lissajous figure, with theta = 2 pi u.

    .. math:: c_i(u) = x_{0i} + A_i (\sin(n_i \theta + \varphi_i) - \sin \varphi_i)

    Attributes:
        start: x_0, shape (3,), in m.
        amplitudes: A, shape (3,), in m.
        frequencies: n, integers, shape (3,).
        phases: varphi, shape (3,), in rad.
    """

    start: FloatArray
    amplitudes: FloatArray
    frequencies: FloatArray
    phases: FloatArray

    def derivatives(self, u: FloatArray) -> FloatArray:
        """Return the point and its first two derivatives by u, shape (T, 3, 3), in m."""
        rate = 2.0 * np.pi * self.frequencies
        phase = np.outer(u, rate) + self.phases
        sine = self.amplitudes * np.sin(phase)
        return np.stack(
            [
                self.start + sine - self.amplitudes * np.sin(self.phases),
                rate * self.amplitudes * np.cos(phase),
                -(rate**2) * sine,
            ],
            axis=1,
        )

    def distance(self, points: FloatArray) -> FloatArray:
        """Return the distance of each point to the figure, shapes (..., 3) to (...), in m."""
        samples = _SAMPLES * int(self.frequencies.max())
        return distance_to_curve(points, self.derivatives, np.linspace(0.0, 1.0, samples + 1))


CONFIG = LissajousConfig


def build(config: LissajousConfig, start: FloatArray) -> Trajectory:
    """Build the Lissajous figure that a config describes; `start` is the tip at t = 0."""
    values = (np.array(value, dtype=float) for value in (config.amplitudes, config.frequencies, config.phases))
    return PathMotion(Lissajous(start, *values), config.duration, config.easing)
