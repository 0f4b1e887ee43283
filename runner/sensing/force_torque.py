"""Six-axis force/torque sensor between flange and tool."""

from typing import Annotated

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import AxisWrench, Hertz, Kilograms, Metres, Radians
from runner.sensing.wrench import wrench_transform

AXES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
UNITS = ("N", "N", "N", "N m", "N m", "N m")

_Six = Field(min_length=6, max_length=6)


class ForceTorqueConfig(StrictModel):
    """Config of the sensor; lists hold Fx, Fy, Fz in N and Mx, My, Mz in N m.

    Attributes:
        range: Largest reading of each axis, in N and N m, both ways.
        resolution: Step of each axis' reading, in N and N m; 0 for none.
        noise: Standard deviation of each axis' reading at rest, in N and N m, a fresh draw per tick.
        bias: Reading without load, in N and N m.
        drift: Standard deviation of the bias' random walk after one second, per axis.
        low_pass: Cut-off frequency of the first-order low-pass through which the load is seen, in Hz; None for none.
        rotation: theta, turn of the sensor about the flange's z axis, in rad.
        height: Distance of the sensor's origin from the flange along its z axis, in m.
        mass: Mass of the sensor, in kg: a load of the arm, which the sensor itself does not feel.
    """

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
        """The sensor's frame in the flange's, shape (4, 4)."""
        c, s = np.cos(self.rotation), np.sin(self.rotation)
        return np.array([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, self.height], [0.0, 0.0, 0.0, 1.0]])

    def reading_variance(self, samples: int) -> FloatArray:
        """Return the variance of the mean of some readings at rest, shape (6,): noise, and q^2/12 of quantisation.

        The second holds, and falls with the number of readings, where the noise is no smaller than half a step.
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
"""An exact sensor without mass in the flange's frame."""


class ForceTorqueSensor:
    """Readings of the wrench that the world and the tool put on the sensor, at the ticks of one control loop.

    A load is turned into the sensor's frame, and the drifting bias added; it passes the low-pass, which starts settled;
    noise is added, and the sum is rounded to the resolution. Beyond the range the reading stays at the range, bias
    included, as a real one does. All draws are made when the sensor is made; a longer run starts alike.

    Args:
        ticks: Number of readings to come.
        period: Time between two readings, in s.
        config: The sensor's numbers.
        generator: Source of the draws.
    """

    def __init__(self, ticks: int, period: float, config: ForceTorqueConfig, generator: np.random.Generator) -> None:
        draws = generator.standard_normal((ticks, 2, 6))
        self._noise = np.array(config.noise) * draws[:, 0]
        steps = np.array(config.drift) * np.sqrt(period) * draws[:, 1]
        steps[:1] = 0.0
        self._bias = np.array(config.bias) + np.cumsum(steps, axis=0)
        self._transform = np.linalg.inv(wrench_transform(config.pose))
        # Exact for a load that is held between ticks.
        self._share = 1.0 if config.low_pass is None else -np.expm1(-2.0 * np.pi * config.low_pass * period)
        self._seen: FloatArray | None = None
        self._range = np.array(config.range)
        resolution = np.array(config.resolution)
        self._rounded = resolution > 0.0
        self._resolution = resolution[self._rounded]
        self._peak = np.zeros(6)

    def read(self, tick: int, wrench: FloatArray) -> FloatArray:
        """Return the reading at a tick.

        Args:
            tick: Number of the reading, from 0.
            wrench: What world and tool, its weight and inertia included, put on the flange: force in N and moment
                about its origin in N m, along its axes, shape (6,).

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
        """Return a text for each axis that has been loaded beyond its range: peak, range and what becomes of it."""
        return [
            f"{axis} reached {peak:.4g} {unit}, beyond the sensor's range of {limit:g} {unit}; its reading stayed there"
            for axis, unit, peak, limit in zip(AXES, UNITS, self._peak, self._range, strict=True)
            if peak > limit
        ]
