"""Tip position sensor, such as a camera or a tracker."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, RadiansPerSecond, Seconds
from runner.sensing.velocity import State, Velocity, first_state, gains, next_velocity


class TipSensorConfig(StrictModel):
    """Config of a tip sensor: the base of the config of each kind.

    Attributes:
        kind: Name in the registry.
        read_by: Names of the control loops that read the sensor; a loop has the name of its stage. An empty list means
            no sensor.
        period: Time between two measurements, in s; None measures at each tick of the loop that reads the sensor.
        delay: Time from a measurement until the loop receives it, in s.
    """

    kind: str
    read_by: list[str]
    period: Seconds[PositiveFloat | None]
    delay: Seconds[NonNegativeFloat]


class EndpointSensorConfig(TipSensorConfig):
    """Config of a tip position sensor.

    Attributes:
        kind: Name in the registry.
        noise: Standard deviation of the noise of each coordinate, in m, drawn again for each measurement.
        velocity: Source of the tip velocity: exact, or an estimate from the measured positions as for the joints.
        velocity_bandwidth: Bandwidth of the velocity estimate, in rad/s, if it has one.
    """

    kind: Literal["endpoint"] = "endpoint"
    noise: Metres[NonNegativeFloat]
    velocity: Velocity
    velocity_bandwidth: RadiansPerSecond[PositiveFloat]


@dataclass(frozen=True)
class EndpointTicks:
    """Times of tip measurements, in ticks of the control loop.

    Attributes:
        every: Number of ticks between two measurements.
        late: Number of ticks until a measurement is available.
    """

    every: int
    late: int


class EndpointSensor:
    """Measured position of the tip, and its velocity. The constructor draws all random numbers, in their order in time.

    Args:
        config: Config of the sensor.
        measurements: Number of measurements.
        period: Time between two of them, in s.
        generator: Random generator.
    """

    def __init__(
        self, config: EndpointSensorConfig, measurements: int, period: float, generator: np.random.Generator
    ) -> None:
        self._noise = config.noise * generator.standard_normal((measurements, 3))
        self._way, self._period = config.velocity, period
        self._gains = gains(config.velocity, config.velocity_bandwidth, period)
        self._state: State | None = None

    def measure(self, number: int, tip: FloatArray) -> FloatArray:
        """Return the measured position and velocity; see TipSensor."""
        position, velocity = tip[0] + self._noise[number], tip[1]
        if self._way != "exact":
            state = first_state(self._way, position) if self._state is None else self._state
            velocity, self._state = next_velocity(self._way, self._gains, self._period, position, state)
        return np.array([position, velocity])


CONFIG = EndpointSensorConfig
build = EndpointSensor
