"""Gravity calibration procedure: tool weighing in several orientations (Meca500 report, section 4)."""

import itertools
from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.limits import READINGS
from runner.calibration.gravity import PARAMETERS, REST, GravityCalibration, WrenchCompensation, identify_gravity
from runner.calibration.orientations import choose_orientations
from runner.calibration.procedure import Bench, Outcome
from runner.robots.model import RobotModel
from runner.schema.model import StrictModel
from runner.schema.units import Metres, Radians
from runner.sensing.force_torque import ForceTorqueSensor
from runner.sensing.wrench import inverse_wrench_transform

_SETTLED = 1e-9  # of a change of load, which the sensor's low-pass leaves unseen when a reading is taken
_TRIED = 50  # orientations in which the compensation is tried


class WeighingConfig(StrictModel):
    """Config of the procedure.

    Attributes:
        kind: Its name in the registry.
        orientations: Their number.
        choice: Whether those are taken of the candidates that weigh best, or the first ones.
        candidates: Number of postures, spread evenly over the joint limits.
        spread: Angle up to which gravity may turn in the flange's frame from where it is at home, in rad; candidates
            beyond it are dropped. None drops none.
        samples: Number of readings that are averaged at each orientation.
        repeatability: To which the arm repeats its flange's position at home, in m.
    """

    kind: Literal["gravity"]
    orientations: Annotated[int, Field(ge=1, le=1000)]
    choice: Literal["best", "first"]
    candidates: Annotated[int, Field(ge=1, le=100_000)]
    spread: Radians[Annotated[float, Field(gt=0.0, le=np.pi)] | None]
    samples: Annotated[int, Field(ge=1, le=100_000)]
    repeatability: Metres[NonNegativeFloat]


class Weighing:
    """The procedure: at rest in each orientation, the sensor's readings are averaged.

    Its measures are the condition numbers of the two steps, and what the compensation leaves of exact readings at rest
    in other orientations all over the joint limits, as root mean squares of force and moment.

    Args:
        config: The orientations and readings.
        bench: The arm.
    """

    estimates: ClassVar[Mapping[str, str]] = dict(
        zip(PARAMETERS, ("kg", "rad", "m", "m", "m", "N", "N", "N", "N m", "N m", "N m"), strict=True)
    )
    errors: ClassVar[Mapping[str, str]] = estimates
    measures: ClassVar[Mapping[str, str]] = {
        "condition_force": "1",
        "condition_moment": "1",
        "residual_force": "N",
        "residual_moment": "N m",
    }

    def __init__(self, config: WeighingConfig, bench: Bench) -> None:
        self._bench, self._config = bench, config
        sensor, tool = bench.sensor, bench.tool
        centre = sensor.pose[:3, :3].T @ (tool.centre_of_mass - sensor.pose[:3, 3])
        self.truth = np.array([tool.mass, sensor.rotation, *centre, *sensor.bias])
        everywhere = even_postures(bench.flange, max(config.candidates, _TRIED))
        self._tried = bench.poses(everywhere[:_TRIED])[:, :3, :3]
        self.postures = self._choose(everywhere[: config.candidates])
        self._loads = self._exact_loads(bench.poses(self.postures)[:, :3, :3])

    def repeat(self, generator: np.random.Generator) -> Outcome:
        """Calibrate once; see Procedure."""
        bench, config = self._bench, self._config
        poses, covariances = bench.read_poses(self.postures, config.repeatability, generator)
        readings, messages = self._read(generator)
        found = identify_gravity(
            readings,
            poses[:, :3, :3],
            bench.gravity,
            bench.sensor.reading_variance(config.samples),
            covariances[:, 3:, 3:],
        )
        force, moment = self._residual(found)
        conditions = found.condition_numbers
        measures = dict(zip(self.measures, (*conditions, force, moment), strict=True))
        return Outcome(found.values, found.values - self.truth, found.covariance, measures, messages)

    def _choose(self, candidates: FloatArray) -> FloatArray:
        config, flange = self._config, self._bench.flange
        orientations = self._bench.poses(candidates)[:, :3, :3]
        if config.spread is not None:
            vertical = flange.tip_pose(self._bench.home)[2, :3]
            near = orientations[:, 2] @ vertical >= np.cos(config.spread)
            candidates, orientations = candidates[near], orientations[near]
        if config.choice == "best":
            return candidates[choose_orientations(orientations, config.orientations)]
        if len(candidates) < config.orientations:
            raise ConfigError(
                f"calibration.candidates: {len(candidates)} are left for {config.orientations} orientations"
            )
        return candidates[: config.orientations]

    def _exact_loads(self, orientations: FloatArray) -> FloatArray:
        """Return the tool's wrench on the flange at rest, along the flange's axes, shape (N, 6)."""
        gravity = self._bench.flange.gravity
        return np.array([self._bench.tool.load(R.T @ gravity, REST) for R in orientations])

    def _read(self, generator: np.random.Generator) -> tuple[FloatArray, list[str]]:
        """Return the mean reading at each orientation, shape (N, 6), and the sensor's overloads."""
        config, period, samples = self._bench.sensor, self._bench.period, self._config.samples
        settling = 0
        if config.low_pass is not None:
            settling = int(np.ceil(-np.log(_SETTLED) / (2.0 * np.pi * config.low_pass * period)))
        each = settling + samples
        if excess := READINGS.excess(each * len(self._loads)):
            raise ConfigError(f"calibration: it {excess}; take fewer samples or orientations, or a higher low_pass")
        sensor = ForceTorqueSensor(each * len(self._loads), period, config, generator)
        readings = np.array(
            [
                [sensor.read(place * each + tick, load) for tick in range(each)][settling:]
                for place, load in enumerate(self._loads)
            ]
        )
        return readings.mean(axis=1), sensor.overloads()

    def _residual(self, found: GravityCalibration) -> tuple[float, float]:
        sensor, tool = self._bench.sensor, self._bench.tool
        along = sensor.pose[:3, :3].T
        inertia = along @ tool.inertia @ along.T
        compensation = WrenchCompensation(found, inertia, self._bench.gravity)
        to_sensor = inverse_wrench_transform(sensor.pose)
        left = np.array(
            [
                compensation.external(to_sensor @ load + sensor.bias, R, REST)
                for load, R in zip(self._exact_loads(self._tried), self._tried, strict=True)
            ]
        )
        force, moment = np.sqrt(np.mean(np.sum(left.reshape(-1, 2, 3) ** 2, axis=2), axis=0))
        return float(force), float(moment)


def even_postures(model: RobotModel, count: int) -> FloatArray:
    """Return postures spread evenly over the joint limits (Halton), shape (count, nq), in rad; always the same ones.

    Halton, "On the efficiency of certain quasi-random sequences of points in evaluating multi-dimensional integrals",
    Numerische Mathematik 2, 1960. An unlimited revolute joint is taken once around.
    """
    lower, upper = np.clip(model.position_limits, -np.pi, np.pi)
    primes = (n for n in itertools.count(2) if all(n % factor for factor in range(2, n)))
    shares = [_mirrored_digits(count, base) for base in itertools.islice(primes, model.nq)]
    postures: FloatArray = lower + np.column_stack(shares) * (upper - lower)
    return postures


def _mirrored_digits(count: int, base: int) -> FloatArray:
    """Return 1, 2, ..., count with their digits in a base mirrored at the point, shape (count,), 0 to 1."""
    left, mirrored, weight = np.arange(1, count + 1), np.zeros(count), 1.0 / base
    while left.any():
        left, digits = np.divmod(left, base)
        mirrored += digits * weight
        weight /= base
    return mirrored


CONFIG = WeighingConfig
build = Weighing
