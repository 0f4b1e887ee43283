"""Checking a composed config: every problem is found before one message lists them all."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from runner.config.arms import build_robot
from runner.config.limits import LimitsConfig, check_memory
from runner.config.noise import NoiseConfig
from runner.config.parsing import attempt, parse, parse_group
from runner.config.per_joint import expand
from runner.config.per_stage import by_stage
from runner.config.preset import PresetConfig
from runner.config.robot import OneArmConfig, RobotConfig
from runner.config.run import RunConfig, RunSettings
from runner.config.sweep import SweepConfig
from runner.config.timing import count_delay, count_steps, count_ticks
from runner.config.torque_limits import TorqueLimitsConfig
from runner.controllers import CONTROLLERS, Loop
from runner.environments import ENVIRONMENTS
from runner.errors import ConfigError, nearest
from runner.plants import PLANTS
from runner.registry import Registry, StrictModel
from runner.robots.mismatch import MismatchConfig
from runner.robots.model import STANDARD_GRAVITY
from runner.robots.robot import Robot, end_points
from runner.sensing import ForceTorqueConfig
from runner.trajectories import TRAJECTORIES, Trajectory

_KINDS: dict[str, Registry] = {
    "plant": PLANTS,
    "controller": CONTROLLERS,
    "trajectory": TRAJECTORIES,
    "environment": ENVIRONMENTS,
}
_PLAIN: dict[str, type[StrictModel]] = {
    "noise": NoiseConfig,
    "torque_limits": TorqueLimitsConfig,
    "wrist_sensor": ForceTorqueConfig,
    "mismatch": MismatchConfig,
    "robot": OneArmConfig,
    "preset": PresetConfig,
    "sweep": SweepConfig,
    "limits": LimitsConfig,
}
GROUPS: dict[str, Registry | type[StrictModel]] = {**_KINDS, **_PLAIN}
_SETTINGS = tuple(RunSettings.model_fields)


def validate(resolved: Mapping[str, Any], config_dirs: Sequence[Path] = ()) -> RunConfig:
    """Check a composed config.

    Args:
        resolved: The config as plain data, interpolations resolved.
        config_dirs: Config folders of the user's, in which URDFs are looked for.

    Raises:
        ConfigError: with every problem found: dotted key, value found, values allowed, nearest valid name.
    """
    problems: list[str] = []
    collect = partial(attempt, problems)
    collect(lambda: _check_groups(resolved))
    settings = collect(lambda: parse("", RunSettings, {key: resolved.get(key) for key in _SETTINGS}))
    parts = {group: collect(partial(parse_group, group, kind, resolved)) for group, kind in GROUPS.items()}
    robot, plant, controller, trajectory = (parts[g] for g in ("robot", "plant", "controller", "trajectory"))
    arm, timing, delay, path, ticks = None, None, None, None, None
    loops: Sequence[Loop] = ()
    if robot is not None:
        collect(lambda: _check_payload(robot, parts["mismatch"]))
        gravity = STANDARD_GRAVITY if settings is None else settings.gravity
        arm = collect(lambda: build_robot(robot, gravity, config_dirs, parts["wrist_sensor"]))
    if arm is not None:
        collect(lambda: _check_stage_values(arm, parts["noise"], parts["torque_limits"]))
        if trajectory is not None:
            collect(lambda: _check_reach(arm, trajectory))
        if plant is not None and controller is not None:
            collect(lambda: _check_commands(plant.kind, controller.kind))
            timing = collect(lambda: count_steps(arm, plant, controller))
        if controller is not None and not problems:
            loops = collect(lambda: CONTROLLERS.build(controller, arm))
    if timing is not None:
        delay = collect(lambda: count_delay(plant, timing[0]))
    if arm is not None and plant is not None and trajectory is not None and not problems:
        path = collect(lambda: _build_trajectory(arm, trajectory, plant))
    if path is not None and timing is not None and settings is not None:
        ticks = collect(lambda: count_ticks(settings, timing[0], path))
    if problems or arm is None or timing is None or delay is None or path is None or ticks is None:
        raise ConfigError(problems)
    tick, step, steps_per_tick = timing
    parts.pop("preset")  # its values have been taken by the other groups
    feels = parts["environment"].kind != "free" or any(loop.feels for loop in loops)
    check_memory(parts["limits"], arm, ticks, tick, settings.repetitions, feels)
    return RunConfig(
        settings=settings,
        **parts,
        arm=arm,
        tick=tick,
        commands=CONTROLLERS.commands(controller.kind),
        step=step,
        steps_per_tick=steps_per_tick,
        delay=delay,
        path=path,
        ticks=ticks,
        resolved=resolved,
    )


def _build_trajectory(arm: Robot, trajectory: Any, plant: Any) -> Trajectory:
    """Return the desired motion, which starts at the tip of home where the config does not say."""
    start = getattr(trajectory, "start", None)
    parallel = len(arm.stages) > 1 and plant.wrist_rotation == "parallel"
    place = end_points(arm, arm.home[None], parallel)[-1, 0] if start is None else np.array(start)
    path: Trajectory = TRAJECTORIES.build(trajectory, place)
    return path


def _check_groups(resolved: Mapping[str, Any]) -> None:
    known = (*_SETTINGS, *_KINDS, *_PLAIN)
    unknown = [str(key) for key in resolved if key not in known]
    if unknown:
        raise ConfigError(f"{key}: unknown key{nearest(key, known)}; keys: {', '.join(known)}" for key in unknown)


def _check_stage_values(arm: Robot, noise: NoiseConfig | None, torque_limits: TorqueLimitsConfig | None) -> None:
    problems: list[str] = []
    for key in ("position", "resolution") if noise is not None else ():
        try:
            by_stage(f"noise.{key}", getattr(noise, key), arm.stage_names)
        except ConfigError as error:
            problems += error.problems
    if torque_limits is not None and torque_limits.max is not None:
        try:
            limits = by_stage("torque_limits.max", torque_limits.max, arm.stage_names)
            for stage, limit in zip(arm.stages, limits, strict=True):
                key = f"torque_limits.max.{stage.name}" if len(arm.stages) > 1 else "torque_limits.max"
                expand(key, limit, stage.model.joint_names)
        except ConfigError as error:
            problems += error.problems
    if problems:
        raise ConfigError(problems)


def _check_payload(robot: RobotConfig, mismatch: MismatchConfig | None) -> None:
    if mismatch is not None and mismatch.payload < -robot.payload.mass:
        raise ConfigError(
            [
                f"mismatch.payload: {mismatch.payload:g} kg is less than nothing of the true payload, "
                f"robot.payload.mass with {robot.payload.mass:g} kg; allowed: {-robot.payload.mass:g} or more"
            ]
        )


def _check_commands(plant: str, controller: str) -> None:
    if CONTROLLERS.commands(controller) == "torque" and PLANTS.commands(plant) == "position":
        fit = [kind for kind in PLANTS.names() if PLANTS.commands(kind) == "torque"]
        raise ConfigError(
            [
                f"plant.kind: {plant} follows joint positions, and {controller} gives torques; take plant="
                f"{' or plant='.join(fit)}, or a controller that commands joint positions"
            ]
        )


def _check_reach(arm: Robot, trajectory: Any) -> None:
    problems = []
    for key in ("start", "goal"):
        point = getattr(trajectory, key, None)
        if point is None:
            continue
        distance = float(np.linalg.norm(np.array(point) - arm.model.shoulder))
        if distance > arm.model.reach * (1.0 + 1e-12):
            problems.append(
                f"trajectory.{key}: {point} m is outside the workspace: {distance:.4g} m from the shoulder, and the "
                f"arm reaches {arm.model.reach:.4g} m"
            )
    if problems:
        raise ConfigError(problems)
