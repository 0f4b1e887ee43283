"""Excitation trajectories: sums of sinusoids for every joint, from rest to rest."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PositiveFloat, ValidationInfo, field_validator

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import Hertz, JointPosition, Seconds
from runner.schema.values import NonNegativePerJoint, expand
from runner.trajectories.joint_motion import Configuration, JointMotion, start_of
from runner.trajectories.motion import quintic_blend

_SAMPLES = 64  # in a period of the highest harmonic
_AT_ONCE = 2_000_000  # sines in memory at the same time

Pair = Annotated[list[float], Field(min_length=2, max_length=2)]


class JointSinusoidsConfig(StrictModel):
    """Config of sums of sinusoids about a configuration.

    Attributes:
        kind: Name of the kind in the registry.
        start_configuration: Configuration about which the joints oscillate, in rad; m for prismatic joints. One value
            for all joints, or a list with one for each joint; None is the home configuration.
        frequency: Fundamental frequency, in Hz.
        harmonics: Number of harmonics, including the fundamental.
        amplitude: Upper bound of the displacement of each joint with random coefficients, in rad; m for prismatic
            joints. One value for all joints, or a list with one for each joint.
        seed: Seed of the random coefficients.
        coefficients: For each joint, a list with the sine and cosine coefficients of each harmonic, in rad; m for
            prismatic joints. None draws random coefficients.
        ramp: Time in which the oscillation grows from rest, and in which it decays to rest, in s.
        duration: t_f, including both ramps, in s.
    """

    kind: Literal["joint_sinusoids"]
    start_configuration: JointPosition[Configuration | None]
    frequency: Hertz[PositiveFloat]
    harmonics: Annotated[int, Field(ge=1, le=100)]
    amplitude: JointPosition[NonNegativePerJoint]
    seed: Annotated[int, Field(ge=0)]
    coefficients: JointPosition[list[list[Pair]] | None]
    ramp: Seconds[PositiveFloat]
    duration: Seconds[PositiveFloat]

    @field_validator("duration")
    @classmethod
    def _check_duration(cls, value: float, info: ValidationInfo) -> float:
        ramp = info.data.get("ramp", 0.0)
        if value < 2.0 * ramp:
            raise ValueError(f"must have room for both ramps, {2.0 * ramp:g} s or more")
        return value


@dataclass(frozen=True)
class JointSinusoids:
    r"""Fourier series about a configuration, multiplied by a window; see JointMotion.

    .. math:: q_i(t) = q_{0i} + w(t) \sum_k a_{ik} \sin k \omega (t - t_r) + b_{ik} \cos k \omega (t - t_r)

    is periodic between the ramps (Swevers, Ganseman, Tuekel, De Schutter and Van Brussel, IEEE Transactions on Robotics
    and Automation 13(5), 1997, without the window). The window w is the quintic blend from 0 to 1 in the ramp time t_r,
    and back to 0 at the end. So the arm starts and ends at rest in q_0.

    Attributes:
        start: q_0, shape (nq,), in rad.
        coefficients: a and b, shape (nq, N, 2), in rad.
        omega: Fundamental frequency, in rad/s.
        ramp: t_r, in s.
        duration: t_f, in s.
    """

    start: FloatArray
    coefficients: FloatArray
    omega: float
    ramp: float
    duration: float

    @property
    def samples(self) -> int:
        """Number of equal time intervals, in proportion to the highest harmonic; see JointMotion."""
        highest = self.coefficients.shape[1] * self.omega / (2.0 * np.pi)
        return int(np.ceil(_SAMPLES * (self.duration * highest + 2.0)))

    def sample(self, times: FloatArray) -> FloatArray:
        """Return the motion; after t_f it rests in q_0."""
        harmonics = self.coefficients.shape[1]
        parts = np.array_split(times, len(times) * harmonics // _AT_ONCE + 1)
        return np.concatenate([self._sample(part) for part in parts])

    def _sample(self, times: FloatArray) -> FloatArray:
        rate = self.omega * np.arange(1, self.coefficients.shape[1] + 1)
        phase = np.outer(times - self.ramp, rate)
        sine, cosine = np.sin(phase), np.cos(phase)
        a, b = self.coefficients[:, :, 0].T, self.coefficients[:, :, 1].T  # (N, nq)
        f = _over_harmonics(sine, a) + _over_harmonics(cosine, b)
        df = _over_harmonics(rate * cosine, a) - _over_harmonics(rate * sine, b)
        ddf = -_over_harmonics(rate**2 * sine, a) - _over_harmonics(rate**2 * cosine, b)
        w, dw, ddw = self._window(times)
        return np.stack(
            [self.start + w * f, dw * f + w * df, ddw * f + 2.0 * dw * df + w * ddf],
            axis=1,
        )

    def _window(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return w and its first two derivatives, each of shape (T, 1)."""
        opens = quintic_blend(times / self.ramp)
        closes = quintic_blend((self.duration - times) / self.ramp)
        signs = (1.0, -1.0, 1.0)
        w, dw, ddw = (
            (one + sign * other)[:, None] / self.ramp**order
            for order, (one, other, sign) in enumerate(zip(opens, closes, signs, strict=True))
        )
        return w - 1.0, dw, ddw


CONFIG = JointSinusoidsConfig


def joint_motion(config: JointSinusoidsConfig, robot: Robot) -> JointMotion:
    """Build the motion that a config describes.

    Raises:
        ConfigError: if the number of values differs from the number of joints.
    """
    names = robot.model.joint_names
    if config.coefficients is None:
        amplitude = np.array(expand("trajectory.amplitude", config.amplitude, names))
        coefficients = _draw(amplitude, config.harmonics, np.random.default_rng(config.seed))
    else:
        _check(config.coefficients, config.harmonics, names)
        coefficients = np.array(config.coefficients)
    return JointSinusoids(
        start_of(config.start_configuration, robot),
        coefficients,
        2.0 * np.pi * config.frequency,
        config.ramp,
        config.duration,
    )


def _over_harmonics(waves: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Return the sums over the harmonics, shapes (T, N) and (N, nq) to (T, nq), in a fixed order; BLAS has none."""
    total = np.zeros((len(waves), coefficients.shape[1]))
    for wave, coefficient in zip(waves.T, coefficients, strict=True):
        total += wave[:, None] * coefficient
    return total


def _draw(amplitude: FloatArray, harmonics: int, generator: np.random.Generator) -> FloatArray:
    """Return uniformly drawn coefficients, scaled so that no joint exceeds its amplitude, shape (nq, N, 2)."""
    drawn = generator.uniform(-1.0, 1.0, (len(amplitude), harmonics, 2))
    largest = np.linalg.norm(drawn, axis=2).sum(axis=1)  # all harmonics at their peaks at the same time
    coefficients: FloatArray = drawn * (amplitude / largest)[:, None, None]
    return coefficients


def _check(coefficients: list[list[Pair]], harmonics: int, names: tuple[str, ...]) -> None:
    key = "trajectory.coefficients"
    if len(coefficients) != len(names):
        raise ConfigError(f"{key}: {len(coefficients)} lists for {len(names)} joints ({', '.join(names)})")
    problems = [
        f"{key}.{joint}: {len(own)} pairs for trajectory.harmonics, {harmonics}"
        for joint, own in enumerate(coefficients)
        if len(own) != harmonics
    ]
    if problems:
        raise ConfigError(problems)
