"""Six-axis force/torque sensor between flange and tool."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import AxisWrench, Hertz, Kilograms, Metres, Radians
from runner.sensing.wrench import inverse_wrench_transform

AXES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
UNITS = ("N", "N", "N", "N m", "N m", "N m")

_Six = Field(min_length=6, max_length=6)


class ForceTorqueConfig(StrictModel):
    """Config of the sensor; lists contain Fx, Fy, Fz in N and Mx, My, Mz in N m.

    Attributes:
        kind: Name in the registry.
        range: Largest absolute reading of each axis, in N and N m.
        resolution: Step of the reading of each axis, in N and N m; 0 for none.
        noise: Standard deviation of the reading of each axis, in N and N m, drawn again at each tick.
        bias: Reading of each axis without load, in N and N m.
        drift: Standard deviation of the random walk of the bias after one second, for each axis.
        low_pass: Cut-off frequency of a first-order low-pass filter of the load, in Hz; None for no filter.
        rotation: Rotation theta of the sensor about the z axis of the flange, in rad.
        height: Distance of the sensor's origin from the flange along the z axis of the flange, in m.
        mass: Mass of the sensor, in kg; it loads the arm and does not appear in the readings.
    """

    kind: Literal["force_torque"] = "force_torque"
    range: AxisWrench[Annotated[list[PositiveFloat], _Six]]
    resolution: AxisWrench[Annotated[list[NonNegativeFloat], _Six]]
    noise: AxisWrench[Annotated[list[NonNegativeFloat], _Six]]
    bias: AxisWrench[Annotated[list[float], _Six]]
    drift: Annotated[list[NonNegativeFloat], _Six]
    low_pass: Hertz[PositiveFloat | None]
    rotation: Radians[float]
    height: Metres[NonNegativeFloat]
    mass: Kilograms[NonNegativeFloat]

    @property
    def pose(self) -> FloatArray:
        """Pose of the sensor's frame in the flange's frame, shape (4, 4)."""
        c, s = np.cos(self.rotation), np.sin(self.rotation)
        return np.array([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, self.height], [0.0, 0.0, 0.0, 1.0]])

    def reading_variance(self, samples: int) -> FloatArray:
        """Return the variance of the mean of several readings at rest, shape (6,): noise, and q^2/12 for quantisation.

        The term for quantisation is valid only if the noise is at least half a step; otherwise it does not decrease
        with the number of readings.
        """
        variance: FloatArray = (np.square(self.noise) + np.square(self.resolution) / 12.0) / samples
        return variance


IDEAL = ForceTorqueConfig(
    range=[1e9] * 6,
    resolution=[0.0] * 6,
    noise=[0.0] * 6,
    bias=[0.0] * 6,
    drift=[0.0] * 6,
    low_pass=None,
    rotation=0.0,
    height=0.0,
    mass=0.0,
)
"""Exact sensor without mass in the flange's frame."""


class ForceTorqueSensor:
    """Readings of the wrench of environment and tool on the sensor, at the ticks of one control loop.

    The load is transformed to the sensor's frame, and the drifting bias is added. The sum passes the low-pass filter,
    which starts in steady state. Then noise is added, and the sum is rounded to the resolution. The reading, including
    the bias, saturates at the range. The constructor draws all random numbers, so the start of a longer run is the
    same.

    Args:
        ticks: Number of readings.
        period: Time between two readings, in s.
        config: Config of the sensor.
        generator: Random generator.
    """

    def __init__(self, ticks: int, period: float, config: ForceTorqueConfig, generator: np.random.Generator) -> None:
        draws = generator.standard_normal((ticks, 2, 6))
        self._noise = np.array(config.noise) * draws[:, 0]
        steps = np.array(config.drift) * np.sqrt(period) * draws[:, 1]
        steps[:1] = 0.0
        self._bias = np.array(config.bias) + np.cumsum(steps, axis=0)
        self._transform = inverse_wrench_transform(config.pose)
        # Exact for a load that is constant between ticks.
        self._share = 1.0 if config.low_pass is None else -math.expm1(-2.0 * math.pi * config.low_pass * period)
        self._seen: FloatArray | None = None
        self._range = np.array(config.range)
        resolution = np.array(config.resolution)
        self._rounded = resolution > 0.0
        self._resolution = resolution[self._rounded]
        self._peak = np.zeros(6)

    def read(self, tick: int, wrench: FloatArray) -> FloatArray:
        """Return the reading at a tick.

        Args:
            tick: Index of the reading, from 0.
            wrench: Wrench of environment and tool, with its weight and inertia, on the flange: force in N and moment
                about the flange's origin in N m, along the flange's axes, shape (6,).

        Returns:
            Force in N and moment about the sensor's origin in N m, along the sensor's axes, shape (6,).
        """
        load = self._transform @ wrench + self._bias[tick]
        self._seen = load if self._seen is None else self._seen + self._share * (load - self._seen)
        value = self._seen + self._noise[tick]
        value[self._rounded] = self._resolution * np.round(value[self._rounded] / self._resolution)
        np.maximum(self._peak, np.abs(value), out=self._peak)
        reading: FloatArray = np.clip(value, -self._range, self._range)
        return reading

    def overloads(self) -> list[str]:
        """Return a message with the peak and the range of each axis whose load exceeded its range."""
        return [
            f"{axis} reached {peak:.4g} {unit}, beyond the sensor's range of {limit:g} {unit}; its reading stayed there"
            for axis, unit, peak, limit in zip(AXES, UNITS, self._peak, self._range, strict=True)
            if peak > limit
        ]


CONFIG = ForceTorqueConfig


def build(config: ForceTorqueConfig, ticks: int, period: float, generator: np.random.Generator) -> ForceTorqueSensor:
    """Build the sensor of a run."""
    return ForceTorqueSensor(ticks, period, config, generator)
