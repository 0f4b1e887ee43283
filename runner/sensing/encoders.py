"""Joint encoders: joint positions noisy, biased and in steps, and velocities exact or differenced."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class EncoderNoise:
    """Noise, bias and steps of the encoders of a robot's joints.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of each joint's position noise, shape (nq,),
            in rad.
        bias: Constant error of each joint's measured position, shape (nq,), in rad: a zero that is set wrong.
        resolution: Step to which each joint's biased, noisy position is rounded, shape (nq,), in rad; 0 for none.
        distribution: Shape of the position noise.
        velocity: Whether velocities are exact, or differences of the measured positions over the loop's period.
    """

    position: FloatArray
    bias: FloatArray
    resolution: FloatArray
    distribution: Literal["uniform", "gaussian", "none"]
    velocity: Literal["exact", "finite_difference"]


class JointEncoders:
    """The joint measurement of one control loop: a fresh noise draw per joint at each of its ticks.

    All draws are made when the sensor is made, so that equal generators give equal noise whatever the loop does.

    Args:
        ticks: Number of measurements to come.
        period: Time between two measurements, in s.
        noise: Noise, bias and steps of the joints.
        generator: Source of the draws.
    """

    def __init__(self, ticks: int, period: float, noise: EncoderNoise, generator: np.random.Generator) -> None:
        shape = (ticks, len(noise.position))
        if noise.distribution == "none":
            self._error = np.zeros(shape)
        elif noise.distribution == "uniform":
            self._error = noise.position * generator.uniform(-1.0, 1.0, shape)
        else:
            self._error = noise.position * generator.standard_normal(shape)
        if noise.bias.any():
            self._error += noise.bias
        self._rounded = noise.resolution > 0.0
        self._resolution = noise.resolution[self._rounded]
        self._period = period
        self._differenced = noise.velocity == "finite_difference"
        self._last: FloatArray | None = None

    def measure(self, tick: int, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return measured joint positions and velocities, shapes (nq,), from the true ones at a tick.

        A differenced velocity starts from the first measurement: it is zero there, as the arm starts at rest. So
        a bias is not in it.
        """
        measured = q + self._error[tick]
        if len(self._resolution):
            measured[self._rounded] = np.round(measured[self._rounded] / self._resolution) * self._resolution
        if not self._differenced:
            return measured, dq
        velocity = np.zeros_like(q) if self._last is None else (measured - self._last) / self._period
        self._last = measured
        return measured, velocity
