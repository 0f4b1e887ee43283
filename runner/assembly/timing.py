"""Times of a run, with their checks: plant step, control periods and duration."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from runner.assembly.arms import RobotOutline
from runner.base.errors import ConfigError
from runner.config.settings import RunSettings
from runner.controllers import CONTROLLERS, ControllerConfig
from runner.plants import PLANTS, PlantConfig, options_of
from runner.schema.values import by_stage
from runner.trajectories import Trajectory

_MAX_STEPS = 100_000  # of the plant in a tick


@dataclass(frozen=True)
class Steps:
    """Time steps of loops and plant.

    Attributes:
        tick: Period of the fastest loop, in s: of the controller, or of the servo below it.
        step: Integration step of the plant, in s.
        steps_per_tick: Integration steps in one tick.
    """

    tick: float
    step: float
    steps_per_tick: int


@dataclass(frozen=True)
class Timing(Steps):
    """The times of a run: its time steps, delays and length.

    Attributes:
        late: Delay of the commands of each control loop, in ticks, without jitter.
        even: True if every command acts, and all commands of a loop have the same delay.
        ticks: Number of ticks of the run.
    """

    late: tuple[int, ...]
    even: bool
    ticks: int

    @property
    def delay(self) -> int | None:
        """Delay of all commands, in ticks; None if delays differ."""
        return self.late[0] if self.even and len(set(self.late)) == 1 else None


def count_steps(arm: RobotOutline, plant: PlantConfig, controller: ControllerConfig) -> Steps:
    """Return the time steps for a plant and its controller.

    Raises:
        ConfigError: for a period that is not a multiple of the fastest one, for a fastest period that is not a multiple
            of the plant step or has too many steps, or for a servo slower than its commands.
    """
    periods = _periods(arm, controller.period)
    slowest = max(periods.values())
    servo = options_of(plant).servo if PLANTS.commands(plant.kind) == "torque" else None
    if servo is not None and CONTROLLERS.commands(controller.kind) == "position":
        periods = {"plant.servo.period": servo.period, **periods}
    fastest = min(periods, key=lambda name: periods[name])
    tick = periods[fastest]
    step = PLANTS.features(plant.kind).default_step(tick, len(arm.stages)) if plant.step is None else plant.step
    problems = []
    if fastest != "plant.servo.period" and "plant.servo.period" in periods:
        problems.append(
            f"plant.servo.period: {periods['plant.servo.period']:g} s is longer than controller.period, {slowest:g} s; "
            "the servo must be as fast as its commands, or faster"
        )
    problems += [
        f"{name}: {period:g} s is not a multiple of the fastest loop's, {fastest} with {tick:g} s"
        for name, period in periods.items()
        if not _is_multiple(period, tick)
    ]
    steps = max(round(tick / step), 1)
    if steps > _MAX_STEPS:
        problems.append(
            f"plant.step: {step:g} s are {steps:.3g} steps in {fastest}, {tick:g} s; allowed: up to {_MAX_STEPS} steps"
        )
    elif not _is_multiple(tick, step):
        problems.append(
            f"{fastest}: {tick:g} s is not a multiple of plant.step, {step:g} s; "
            f"set plant.step to the period divided by a whole number, such as {tick / steps:g}"
        )
    if problems:
        raise ConfigError(problems)
    return Steps(tick, step, steps)


def count_ticks(settings: RunSettings, steps: Steps, path: Trajectory) -> int:
    """Return the number of ticks of a run.

    Raises:
        ConfigError: if it is shorter than a tick.
    """
    tick = steps.tick
    if settings.duration is not None and settings.duration < tick:
        raise ConfigError(f"duration: {settings.duration:g} s is shorter than one controller period, {tick:g} s")
    duration = path.run_duration if settings.duration is None else settings.duration
    return math.ceil(duration / tick - 1e-9)


def _periods(arm: RobotOutline, period: float | Mapping[str, float]) -> dict[str, float]:
    """Return the period of each loop by its key; a controller with one period has one loop for all stages."""
    if isinstance(period, Mapping):
        by_name: list[float] = by_stage("controller.period", period, arm.stage_names)
        return {f"controller.period.{name}": value for name, value in zip(arm.stage_names, by_name, strict=True)}
    return {"controller.period": period}


def _is_multiple(period: float, unit: float) -> bool:
    return round(period / unit) >= 1 and abs(round(period / unit) * unit - period) <= 1e-9 * period
