"""Tip position sensor, such as a camera or a tracker, and its correction of the encoder kinematics."""

from dataclasses import dataclass

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.schema.model import StrictModel
from runner.schema.units import Metres, RadiansPerSecond, Seconds
from runner.sensing.velocity import State, Velocity, first_state, gains, next_velocity


class EndpointSensorConfig(StrictModel):
    """Config of a sensor of the tip's position.

    Attributes:
        read_by: Names of the control loops that read it; a loop is named after its stage. None: there is no sensor.
        noise: Standard deviation of each coordinate, in m; a fresh draw for each measurement.
        period: Time between two measurements, in s; None is each tick of the loop that reads it.
        delay: Time from a measurement until the loop knows it, in s.
        velocity: How the tip's velocity is known: exactly, or from the measured positions as joint velocities are.
        velocity_bandwidth: Bandwidth of that, in rad/s, where it has one.
    """

    read_by: list[str]
    noise: Metres[NonNegativeFloat]
    period: Seconds[PositiveFloat | None]
    delay: Seconds[NonNegativeFloat]
    velocity: Velocity
    velocity_bandwidth: RadiansPerSecond[PositiveFloat]


@dataclass(frozen=True)
class EndpointTicks:
    """When a control loop measures the tip, in its own ticks.

    Attributes:
        every: Ticks between two measurements.
        late: Ticks until one is known.
    """

    every: int
    late: int


class EndpointSensor:
    r"""The tip as one control loop measures it, against the tip that its joints' encoders tell.

    .. math:: \Delta = y - p(\hat q), \qquad \dot\Delta = \dot y - J(\hat q) \hat{\dot q}

    A law that leads the tip by the encoders to x_d - Delta leads the measured tip to x_d: so each law takes the
    sensor in place of what lies between the encoders and the tip, whatever bends there. Measurement and encoders are
    compared at one instant; the result is known by the delay later and held until the next one. Before the first it
    is 0. All draws are made when the sensor is made; a longer run starts alike.

    Args:
        ticks: Number of ticks of the loop to come.
        period: Time between two, in s.
        config: The sensor's numbers.
        times: When it measures.
        generator: Source of the draws.
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
        """Tell whether the tip is measured at a tick of the loop."""
        return tick % self._times.every == 0

    def measure(self, tick: int, tip: FloatArray, told: FloatArray) -> None:
        """Compare the tip with what the encoders tell of it, at a tick at which it is due.

        Args:
            tick: Number of the loop's tick, from 0.
            tip: True position and velocity of the tip, shape (2, 3), in m and m/s.
            told: The same as the joints' encoders tell it, likewise.
        """
        position = tip[0] + self._noise[tick // self._times.every]
        velocity = tip[1]
        if self._way != "exact":
            state = first_state(self._way, position) if self._state is None else self._state
            velocity, self._state = next_velocity(self._way, self._gains, self._period, position, state)
        self._found.append(np.array([position, velocity]) - told)

    def correction(self, tick: int) -> FloatArray:
        """Return Delta and its rate as they are known at a tick of the loop, shape (2, 3), in m and m/s."""
        known = (tick - self._times.late) // self._times.every
        return self._found[known] if known >= 0 else np.zeros((2, 3))
