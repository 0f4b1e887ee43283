"""Joint encoders: noise, bias and resolution of positions, with exact or estimated velocities."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from runner.base.arrays import FloatArray
from runner.sensing.streams import generators
from runner.sensing.velocity import DEFAULT_BANDWIDTH, State, Velocity, first_state, gains, next_velocity


@dataclass(frozen=True)
class EncoderNoise:
    """Noise, bias and resolution of joint encoders.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of the position noise of each joint,
            shape (nq,), in rad.
        bias: Constant error of the measured position of each joint, as from a wrong zero, shape (nq,), in rad.
        resolution: Step to which the biased, noisy position of each joint is rounded, shape (nq,), in rad; 0 for none.
        distribution: Distribution of the position noise.
        velocity: Source of the velocities: exact, or an estimate from the positions measured at the ticks of the loop.
        velocity_bandwidth: Bandwidth of the velocity estimate, in rad/s, if it has one.
    """

    position: FloatArray
    bias: FloatArray
    resolution: FloatArray
    distribution: Literal["uniform", "gaussian", "none"]
    velocity: Velocity
    velocity_bandwidth: float = DEFAULT_BANDWIDTH


class JointEncoders:
    """Joint measurement of one control loop, with new random noise for each joint at each tick of the loop.

    The constructor draws all random numbers. So equal generators give equal noise, independent of the loop.

    Args:
        ticks: Number of measurements.
        period: Time between two measurements, in s.
        noise: Noise, bias and resolution of the joints.
        generator: Random generator.
    """

    def __init__(self, ticks: int, period: float, noise: EncoderNoise, generator: np.random.Generator) -> None:
        self.errors: FloatArray = _errors([noise], ticks, [generator])[0]
        """Noise and bias of the joint positions at each tick, shape (ticks, nq), in rad."""
        self._rounded = noise.resolution > 0.0
        self._resolution = noise.resolution[self._rounded]
        self._period = period
        self._way = noise.velocity
        self._gains = gains(noise.velocity, noise.velocity_bandwidth, period)
        self._state: State | None = None

    def measure(self, tick: int, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return measured joint positions and velocities, shapes (nq,), from the true ones at a tick.

        An estimated velocity is zero at the first measurement, because the arm starts at rest. So the bias has no
        effect on it.
        """
        measured = q + self.errors[tick]
        if len(self._resolution):
            measured[self._rounded] = np.round(measured[self._rounded] / self._resolution) * self._resolution
        if self._way == "exact":
            return measured, dq
        state = first_state(self._way, measured) if self._state is None else self._state
        velocity, self._state = next_velocity(self._way, self._gains, self._period, measured, state)
        return measured, velocity


def encoder_errors(noises: Sequence[EncoderNoise], seeds: Sequence[Sequence[int]], ticks: int) -> FloatArray:
    """Return the errors of the measured positions of many runs, before rounding to the resolution.

    The errors are bitwise equal to those of `JointEncoders` with the generator `np.random.default_rng(seed)`.

    Args:
        noises: Noise of the encoders of each run, all with the same number of joints.
        seeds: Random seed of each run: seed, repetition and index of the control loop.
        ticks: Number of measurements of a run.

    Returns:
        Shape (runs, ticks, nq), in rad.
    """
    return _errors(noises, ticks, generators(seeds))


def _errors(noises: Sequence[EncoderNoise], ticks: int, generators: Iterable[np.random.Generator]) -> FloatArray:
    nq = len(noises[0].position)
    errors = np.empty((len(noises), ticks * nq))
    rows: dict[int, tuple[FloatArray, FloatArray | None]] = {}  # by noise, because many runs can share one
    for noise, error, generator in zip(noises, errors, generators, strict=True):
        if id(noise) not in rows:
            rows[id(noise)] = (
                np.tile(noise.position, ticks),
                np.tile(noise.bias, ticks) if noise.bias.any() else None,
            )
        width, bias = rows[id(noise)]
        if noise.distribution == "none":
            error[:] = 0.0
        elif noise.distribution == "uniform":
            generator.random(out=error)
            error *= 2.0  # with the next line, bitwise equal to `uniform(-1, 1)`
            error -= 1.0
            error *= width
        else:
            generator.standard_normal(out=error)
            error *= width
        if bias is not None:
            error += bias
    return errors.reshape(len(noises), ticks, nq)
