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
    """Noise, bias and steps of the encoders of a robot's joints.

    Attributes:
        position: Half-width (uniform) or standard deviation (gaussian) of each joint's position noise, shape (nq,),
            in rad.
        bias: Constant error of each joint's measured position, shape (nq,), in rad: a zero that is set wrong.
        resolution: Step to which each joint's biased, noisy position is rounded, shape (nq,), in rad; 0 for none.
        distribution: Shape of the position noise.
        velocity: How velocities are known: exactly, or from the measured positions at the loop's ticks.
        velocity_bandwidth: Bandwidth of that, in rad/s, where it has one.
    """

    position: FloatArray
    bias: FloatArray
    resolution: FloatArray
    distribution: Literal["uniform", "gaussian", "none"]
    velocity: Velocity
    velocity_bandwidth: float = DEFAULT_BANDWIDTH


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

        A velocity that is not exact starts from the first measurement: it is zero there, as the arm starts at rest. So
        a bias is not in it.
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
    """Return the errors of the measured positions of many runs, before they are rounded to steps.

    They are those of `JointEncoders` with the generator `np.random.default_rng(seed)`, to the last bit.

    Args:
        noises: Noise of each run's encoders, all of as many joints.
        seeds: Seed of each run's draws: seed, repetition and place of the control loop.
        ticks: Number of measurements of a run.

    Returns:
        Shape (runs, ticks, nq), in rad.
    """
    return _errors(noises, ticks, generators(seeds))


def _errors(noises: Sequence[EncoderNoise], ticks: int, generators: Iterable[np.random.Generator]) -> FloatArray:
    nq = len(noises[0].position)
    errors = np.empty((len(noises), ticks * nq))
    rows: dict[int, tuple[FloatArray, FloatArray | None]] = {}  # of a noise, which many runs may share
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
            error *= 2.0  # together with the next line exact, as `uniform(-1, 1)` is
            error -= 1.0
            error *= width
        else:
            generator.standard_normal(out=error)
            error *= width
        if bias is not None:
            error += bias
    return errors.reshape(len(noises), ticks, nq)
