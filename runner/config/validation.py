"""Checking a composed config: every problem is found before one message lists them all."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from runner.config.messages import describe
from runner.config.noise import NoiseConfig
from runner.config.per_joint import expand
from runner.config.preset import PresetConfig
from runner.config.robot import RobotConfig
from runner.config.run import RunConfig, RunSettings
from runner.config.torque_limits import TorqueLimitsConfig
from runner.controllers import CONTROLLERS
from runner.errors import ConfigError, nearest
from runner.plants import PLANTS
from runner.registry import Registry, StrictModel
from runner.robots import RobotModel, find_urdf, read_urdf
from runner.robots.model import STANDARD_GRAVITY
from runner.trajectories import TRAJECTORIES

_KINDS: dict[str, Registry] = {"plant": PLANTS, "controller": CONTROLLERS, "trajectory": TRAJECTORIES}
_PLAIN: dict[str, type[StrictModel]] = {
    "noise": NoiseConfig,
    "torque_limits": TorqueLimitsConfig,
    "robot": RobotConfig,
    "preset": PresetConfig,
}
_SETTINGS = tuple(RunSettings.model_fields)
_MAX_TICKS = 10_000_000


def validate(resolved: Mapping[str, Any], config_dirs: Sequence[Path] = ()) -> RunConfig:
    """Check a composed config.

    Args:
        resolved: The config as plain data, interpolations resolved.
        config_dirs: Config folders of the user's, in which URDFs are looked for.

    Raises:
        ConfigError: with every problem found: dotted key, value found, values allowed, nearest valid name.
    """
    problems: list[str] = []

    def collect(check: Callable[[], Any]) -> Any:  # noqa: ANN401 - passes on what the check returns
        try:
            return check()
        except ConfigError as error:
            problems.extend(error.problems)
            return None

    collect(lambda: _check_groups(resolved))
    settings = collect(lambda: _parse("", RunSettings, {key: resolved.get(key) for key in _SETTINGS}))
    parts = {group: collect(partial(_parse_group, group, resolved)) for group in (*_KINDS, *_PLAIN)}
    robot, plant, controller, trajectory = (parts[g] for g in ("robot", "plant", "controller", "trajectory"))
    built, timing = None, None
    if robot is not None:
        gravity = STANDARD_GRAVITY if settings is None else settings.gravity
        built = collect(lambda: _build_model(robot, gravity, config_dirs))
    if built is not None:
        model, urdf = built
        collect(lambda: _check_joint_values(model, robot, parts["torque_limits"]))
        if trajectory is not None:
            collect(lambda: _check_reach(model, trajectory))
        if controller is not None and not problems:
            collect(lambda: CONTROLLERS.build(controller, model))
    if plant is not None and controller is not None:
        timing = collect(lambda: _count_steps(plant, controller))
    if settings is not None and controller is not None and trajectory is not None:
        collect(lambda: _check_duration(settings, controller, trajectory))
    if problems or built is None or timing is None:
        raise ConfigError(problems)
    step, steps_per_tick = timing
    parts.pop("preset")  # its values have been taken by the other groups
    return RunConfig(
        settings=settings,
        **parts,
        model=model,
        urdf=urdf,
        step=step,
        steps_per_tick=steps_per_tick,
        resolved=resolved,
    )


def _check_groups(resolved: Mapping[str, Any]) -> None:
    known = (*_SETTINGS, *_KINDS, *_PLAIN)
    unknown = [key for key in resolved if key not in known]
    if unknown:
        raise ConfigError(f"{key}: unknown key{nearest(key, known)}; keys: {', '.join(known)}" for key in unknown)


def _parse_group(group: str, resolved: Mapping[str, Any]) -> StrictModel:
    value = resolved.get(group)
    if not isinstance(value, Mapping):
        raise ConfigError([f"{group}: must be a group of keys; found {value!r}"])
    if group in _PLAIN:
        return _parse(group, _PLAIN[group], value)
    registry = _KINDS[group]
    if "kind" not in value:
        raise ConfigError([f"{group}.kind: missing; known: {', '.join(registry.names())}"])
    return _parse(group, registry.config_model(str(value["kind"])), value)


def _parse(group: str, model: type[StrictModel], value: Mapping[str, Any]) -> StrictModel:
    try:
        return model.model_validate(dict(value))
    except ValidationError as error:
        raise ConfigError(describe(group, model, error)) from None


def _build_model(robot: RobotConfig, gravity: float, config_dirs: Sequence[Path]) -> tuple[RobotModel, str]:
    urdf = read_urdf(find_urdf(robot.urdf, config_dirs), robot.masses)
    return RobotModel(urdf, robot.tip, gravity), urdf


def _check_joint_values(model: RobotModel, robot: RobotConfig, torque_limits: TorqueLimitsConfig | None) -> None:
    expand("robot.home", robot.home, model.joint_names)
    if torque_limits is not None and torque_limits.max is not None:
        expand("torque_limits.max", torque_limits.max, model.joint_names)


def _check_reach(model: RobotModel, trajectory: Any) -> None:  # noqa: ANN401 - any registered kind
    problems = []
    for key in ("start", "goal"):
        point = getattr(trajectory, key, None)
        if point is None:
            continue
        distance = float(np.linalg.norm(np.array(point) - model.shoulder))
        if distance > model.reach * (1.0 + 1e-12):
            problems.append(
                f"trajectory.{key}: {point} m is outside the workspace: {distance:.4g} m from the shoulder, and the "
                f"arm reaches {model.reach:.4g} m"
            )
    if problems:
        raise ConfigError(problems)


def _count_steps(plant: Any, controller: Any) -> tuple[float, int]:  # noqa: ANN401 - any registered kinds
    step = PLANTS.default_step(plant.kind, controller.period) if plant.step is None else plant.step
    steps = round(controller.period / step)
    if steps < 1 or abs(steps * step - controller.period) > 1e-9 * controller.period:
        raise ConfigError(
            [
                f"controller.period: {controller.period:g} s is no multiple of plant.step, {step:g} s; "
                f"set plant.step to the period divided by a whole number, such as {controller.period / max(steps, 1):g}"
            ]
        )
    return step, steps


def _check_duration(settings: RunSettings, controller: Any, trajectory: Any) -> None:  # noqa: ANN401 - any kinds
    key, length = "duration", settings.duration
    if length is None:
        key, length = "trajectory.duration", getattr(trajectory, "duration", controller.period)
    elif length < controller.period:
        raise ConfigError([f"duration: {length:g} s is shorter than one controller period, {controller.period:g} s"])
    ticks = length / controller.period
    if ticks > _MAX_TICKS:
        raise ConfigError(
            [
                f"{key}: {length:g} s are {ticks:.3g} ticks of controller.period, {controller.period:g} s; allowed: "
                f"up to {_MAX_TICKS:g} ticks, as a run is kept in memory"
            ]
        )
