"""Joint encoders: noise, bias and resolution of positions, with exact or estimated velocities."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.schema.model import StrictModel
from runner.schema.units import JointPosition, RadiansPerSecond
from runner.schema.values import FinitePerStage, NonNegativePerStage, by_stage
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
        kind: Name in the registry.
    """

    position: FloatArray
    bias: FloatArray
    resolution: FloatArray
    distribution: Literal["uniform", "gaussian", "none"]
    velocity: Velocity
    velocity_bandwidth: float = DEFAULT_BANDWIDTH
    kind: str = "encoders"

    def round(self, positions: FloatArray) -> None:
        """Round positions, shape (..., nq), to the resolution in place."""
        some = self.resolution > 0.0
        positions[..., some] = np.round(positions[..., some] / self.resolution[some]) * self.resolution[some]


class NoiseConfig(StrictModel):
    """Noise, bias and resolution of the joint encoders.

    Attributes:
        kind: Name in the registry.
        position: Half-width (uniform) or standard deviation (gaussian) of the joint-position noise, in rad; m for
            prismatic joints. By stage if the robot has several.
        distribution: Distribution of the noise; with none, `position` has no effect.
        bias: Constant error of the measured joint positions, such as a wrong zero, in rad; m for prismatic joints. By
            stage if the robot has several. It has either sign and is the same at every tick and in every repetition.
        resolution: Step to which the biased, noisy joint positions are rounded, in rad; m for prismatic joints. By
            stage if the robot has several; 0 for no rounding.
        velocity: Source of joint velocities: exact, differences of the measured positions, the same after a first-order
            low-pass, or a Luenberger observer of each joint.
        velocity_bandwidth: Cut-off of the low-pass, and both poles of the observer, in rad/s.
    """

    kind: Literal["encoders"] = "encoders"
    position: JointPosition[NonNegativePerStage]
    distribution: Literal["uniform", "gaussian", "none"]
    bias: JointPosition[FinitePerStage] = 0.0
    resolution: JointPosition[NonNegativePerStage] = 0.0
    velocity: Velocity
    velocity_bandwidth: RadiansPerSecond[PositiveFloat] = DEFAULT_BANDWIDTH

    def by_joint(self, units: Mapping[str, Mapping[str, str]]) -> EncoderNoise:
        """Return the noise, bias and resolution of each joint of a robot.

        Args:
            units: Unit of the position of each joint by name, rad or m, by stage.

        Raises:
            ConfigError: for values that do not fit the robot's stages.
        """
        # An omitted key is zero, also for a robot of several stages.
        zero: float | dict[str, float] = dict.fromkeys(units, 0.0) if len(units) > 1 else 0.0
        given = {"bias": self.bias, "resolution": self.resolution}
        values = [("noise.position", self.position)]
        values += [(f"noise.{key}", own if key in self.model_fields_set else zero) for key, own in given.items()]
        found: list[FloatArray] = []
        problems: list[str] = []
        for key, value in values:
            try:
                found.append(_by_joint(key, value, units))
            except ConfigError as error:
                problems += error.problems
        if problems:
            raise ConfigError(problems)
        position, bias, resolution = found
        ways = self.distribution, self.velocity, self.velocity_bandwidth
        return EncoderNoise(position, bias, resolution, *ways, self.kind)


def _by_joint(key: str, value: float | Mapping[str, float], units: Mapping[str, Mapping[str, str]]) -> FloatArray:
    """Return the value of each joint; reject an error of more than half a turn of a revolute joint."""
    values: list[float] = by_stage(key, value, list(units))
    problems = [
        f"{key}{f'.{stage}' if len(units) > 1 else ''}: {each:g} rad is more than half a turn, and no "
        f"measurement of an angle; degrees? write {each:g}deg"
        for stage, each in zip(units, values, strict=True)
        if abs(each) > math.pi and "rad" in units[stage].values()
    ]
    if problems:
        raise ConfigError(problems)
    return np.repeat(values, [len(joints) for joints in units.values()])


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
        self._noise, self._rounded = noise, bool(noise.resolution.any())
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
        if self._rounded:
            self._noise.round(measured)
        if self._way == "exact":
            return measured, dq
        state = first_state(self._way, measured) if self._state is None else self._state
        velocity, self._state = next_velocity(self._way, self._gains, self._period, measured, state)
        return measured, velocity


COMPILED = True
CONFIG = NoiseConfig
by_joint = NoiseConfig.by_joint


def build(
    noise: EncoderNoise, joints: tuple[str, ...], ticks: int, period: float, generator: np.random.Generator
) -> JointEncoders:
    """Build the encoders of a control loop from their noise by joint."""
    return JointEncoders(ticks, period, noise, generator)


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
