"""Tip position sensor, such as a camera or a tracker, and its correction of the encoder kinematics."""

from dataclasses import dataclass

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, RadiansPerSecond, Seconds
from runner.sensing.velocity import State, Velocity, first_state, gains, next_velocity


class EndpointSensorConfig(StrictModel):
    """Config of a tip position sensor.

    Attributes:
        read_by: Names of the control loops that read the sensor; a loop has the name of its stage. An empty list means
            no sensor.
        noise: Standard deviation of the noise of each coordinate, in m, drawn again for each measurement.
        period: Time between two measurements, in s; None measures at each tick of the loop that reads the sensor.
        delay: Time from a measurement until the loop receives it, in s.
        velocity: Source of the tip velocity: exact, or an estimate from the measured positions as for the joints.
        velocity_bandwidth: Bandwidth of the velocity estimate, in rad/s, if it has one.
    """

    read_by: list[str]
    noise: Metres[NonNegativeFloat]
    period: Seconds[PositiveFloat | None]
    delay: Seconds[NonNegativeFloat]
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
    r"""Tip measurement of one control loop, as the difference from the tip position computed from the encoders.

    .. math:: \Delta = y - p(\hat q), \qquad \dot\Delta = \dot y - J(\hat q) \hat{\dot q}

    If a control law moves the tip according to the encoders to x_d - Delta, the measured tip is at x_d. So every law
    can use the sensor, and the measurement corrects any bending between encoders and tip. Measurement and encoders
    refer to the same instant. Their difference is available after the delay and is constant until the next one; it is 0
    before the first one. The constructor draws all random numbers, so the start of a longer run is the same.

    Args:
        ticks: Number of ticks of the loop.
        period: Time between two ticks, in s.
        config: Config of the sensor.
        times: Times of the measurements.
        generator: Random generator.
    """

    def __init__(
        self,
        ticks: int,
        period: float,
        config: EndpointSensorConfig,
        times: EndpointTicks,
        generator: np.random.Generator,
    ) -> None:
        self._noise = config.noise * generator.standard_normal((-(-ticks // times.every), 3))
        self._times, self._period = times, period * times.every
        self._way = config.velocity
        self._gains = gains(config.velocity, config.velocity_bandwidth, self._period)
        self._state: State | None = None
        self._found: list[FloatArray] = []

    def due(self, tick: int) -> bool:
        """Return True if the tip is measured at a tick of the loop."""
        return tick % self._times.every == 0

    def measure(self, tick: int, tip: FloatArray, told: FloatArray) -> None:
        """Compare the measured tip with that from the encoders, at a tick at which a measurement is due.

        Args:
            tick: Index of the loop's tick, from 0.
            tip: True position and velocity of the tip, shape (2, 3), in m and m/s.
            told: Position and velocity of the tip from the encoders, same shape and units.
        """
        position = tip[0] + self._noise[tick // self._times.every]
        velocity = tip[1]
        if self._way != "exact":
            state = first_state(self._way, position) if self._state is None else self._state
            velocity, self._state = next_velocity(self._way, self._gains, self._period, position, state)
        self._found.append(np.array([position, velocity]) - told)

    def correction(self, tick: int) -> FloatArray:
        """Return Delta and its derivative that are available at a tick of the loop, shape (2, 3), in m and m/s."""
        known = (tick - self._times.late) // self._times.every
        return self._found[known] if known >= 0 else np.zeros((2, 3))
