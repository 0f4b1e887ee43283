"""Joint encoders: joint positions noisy and in steps, and velocities exact or differenced."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class JointEncoders:
    """The joint measurement of one control loop: a fresh noise draw per joint at each of its ticks.

    All draws are made when the sensor is made, so that equal generators give equal noise whatever the loop does.

    Args:
        ticks: Number of measurements to come.
        period: Time between two measurements, in s.
        amplitudes: Half-width (uniform) or standard deviation (gaussian) of each joint's position noise, shape (nq,),
            in rad.
        distribution: Shape of the position noise.
        velocity: Whether velocities are exact, or differences of the measured positions over the period.
        resolution: Step to which each joint's noisy position is rounded, shape (nq,), in rad; 0 for none.
        generator: Source of the draws.
    """

    def __init__(
        self,
        ticks: int,
        period: float,
        amplitudes: FloatArray,
        distribution: Literal["uniform", "gaussian", "none"],
        velocity: Literal["exact", "finite_difference"],
        resolution: FloatArray,
        generator: np.random.Generator,
    ) -> None:
        if distribution == "none":
            self._noise = np.zeros((ticks, len(amplitudes)))
        elif distribution == "uniform":
            self._noise = amplitudes * generator.uniform(-1.0, 1.0, (ticks, len(amplitudes)))
        else:
            self._noise = amplitudes * generator.standard_normal((ticks, len(amplitudes)))
        self._rounded = resolution > 0.0
        self._resolution = resolution[self._rounded]
        self._period = period
        self._differenced = velocity == "finite_difference"
        self._last: FloatArray | None = None

    def measure(self, tick: int, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return measured joint positions and velocities, shapes (nq,), from the true ones at a tick.

        A differenced velocity starts from the first measurement: it is zero there, as the arm starts at rest.
        """
        measured = q + self._noise[tick]
        if len(self._resolution):
            measured[self._rounded] = np.round(measured[self._rounded] / self._resolution) * self._resolution
        if not self._differenced:
            return measured, dq
        velocity = np.zeros_like(q) if self._last is None else (measured - self._last) / self._period
        self._last = measured
        return measured, velocity
