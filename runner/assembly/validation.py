"""Validation of a composed config, with one message that lists all problems."""

from collections.abc import Callable, Sequence
from dataclasses import fields

import numpy as np

from runner.assembly.arms import RobotOutline, build_loaded, build_robot, read_outline
from runner.assembly.cross_checks import (
    check_computation,
    check_notch,
    check_observer,
    check_reading,
    check_schedule,
    count_late,
    endpoint_ticks,
)
from runner.assembly.dependent_keys import check_dependent_keys
from runner.assembly.desired_motion import check_path, check_points, check_repeats, find_start
from runner.assembly.engine_check import check_engine
from runner.assembly.flexibility import check_flexible_joints, check_flexible_links
from runner.assembly.input_shaping import shape
from runner.assembly.run_config import RunConfig
from runner.assembly.run_cost import check_memory
from runner.assembly.timing import Steps, Timing, count_steps, count_ticks
from runner.base.errors import ConfigError
from runner.base.memory import Memory
from runner.base.sanitize import few
from runner.config.composed import Composed
from runner.config.groups import read_groups
from runner.config.parsing import Parts, Problems, require
from runner.config.robot import RobotConfig
from runner.controllers import CONTROLLERS, ControllerConfig, Loop
from runner.plants import PLANTS, PlantConfig, options_of
from runner.plugins.registry import KindConfig
from runner.robots.mismatch import MismatchConfig, check_links
from runner.robots.robot import Robot, end_points
from runner.sensing import values_by_joint
from runner.trajectories import TRAJECTORIES, HasStart, Trajectory
from runner.trajectories.joint_motion import TipOfJoints

_MEMORY = Memory(8192)


def validate(composed: Composed) -> RunConfig:
    """Check a composed config.

    The objects built from groups are cached for configs with the same groups, such as the cells of a sweep. Callers
    must not change them.

    Args:
        composed: The config; its config folders are searched for URDFs.

    Raises:
        ConfigError: with every problem found: dotted key, value found, values allowed, nearest valid name.
    """
    problems = Problems(_MEMORY)
    groups = read_groups(composed.resolved, problems)
    settings, robot, sensor = (groups.get(name) for name in ("settings", "robot", "wrist_sensor"))
    plant, controller = groups.get("plant"), groups.get("controller")
    problems.recall(_check_payload, robot, groups.get("mismatch"))
    outline = problems.recall(read_outline, robot, composed.config_dirs)
    noise = problems.recall(_by_joint, "noise", groups.get("noise"), outline)
    torque_sensor = problems.recall(_by_joint, "joint_torque_sensor", groups.get("joint_torque_sensor"), outline)
    torque_limits = problems.recall(RobotOutline.torque_limits, outline, groups.get("torque_limits"))
    problems.recall(_check_commands, plant, controller)
    steps = problems.recall(count_steps, outline, plant, controller)
    problems.report()
    made_of = outline, require(settings).gravity, sensor
    arm = problems.recall(build_robot, *made_of)
    problems.recall(check_points, arm, groups.get("trajectory"))
    problems.recall(_check_mass, arm, plant)
    problems.report()
    problems.recall(check_engine, outline, plant)
    loaded = problems.recall(build_loaded, *made_of)
    built = _build(groups, require(arm), require(steps), problems)
    config = RunConfig(
        **{name: group for name, group in groups.items() if name in _PARTS}
        | built
        | {"noise": noise, "joint_torque_sensor": torque_sensor, "torque_limits": torque_limits}
        | {"loaded": loaded, "notch": groups.get("notch"), "composed": composed}
    )
    for check in _CHECKS:
        check(config)
    check_memory(config.limits, config.arm, config.timing, config.settings.repetitions, config.has_contact)
    return config


def _build(groups: Parts, arm: Robot, steps: Steps, problems: Problems) -> Parts:
    """Return parts of a RunConfig built from valid groups; user-supplied ones may have state and are not cached.

    Raises:
        ConfigError: with every problem found.
    """
    plant, controller, trajectory = groups["plant"], groups["controller"], groups["trajectory"]
    build_loops = problems.attempt if CONTROLLERS.is_user_supplied(controller.kind) else problems.recall
    build_path = problems.attempt if TRAJECTORIES.is_user_supplied(trajectory.kind) else problems.recall
    ignore_base_rotation = problems.recall(_ignores_base_rotation, arm, plant)
    path = build_path(_build_path, arm, trajectory, ignore_base_rotation)
    loops = build_loops(CONTROLLERS.build_for, controller, arm, isinstance(path, TipOfJoints))
    problems.recall(check_links, arm, groups["mismatch"])
    path = problems.attempt(_shape, groups, arm, path, loops)
    build_path(check_path, arm, path)
    ticks = problems.attempt(count_ticks, groups["settings"], steps, path)
    late, even = problems.recall(count_late, plant, loops), options_of(plant).computation.is_even
    problems.report()
    return {
        "arm": arm,
        "loops": loops,
        "commands": CONTROLLERS.commands(controller.kind),
        "path": path,
        "timing": Timing(**vars(steps), late=require(late), even=even, ticks=require(ticks)),
        "ignore_base_rotation": ignore_base_rotation,
    }


def _shape(groups: Parts, arm: Robot, path: Trajectory, loops: tuple[Loop, ...]) -> Trajectory:
    """Return the desired motion after the input shaper, if any; both have the same start."""
    shaper, controller, plant = groups.get("input_shaper"), groups["controller"], groups["plant"]
    if shaper is None:
        return path
    q_start = find_start(controller, arm, path, _ignores_base_rotation(arm, plant))
    return shape(shaper, plant, arm, path, q_start, loops)


_PARTS = {field.name for field in fields(RunConfig)}
# Checks of the whole config.
_CHECKS: Sequence[Callable[[RunConfig], object]] = (
    check_dependent_keys, check_schedule, check_computation, check_observer, check_notch, check_flexible_joints,
    check_flexible_links, check_reading, endpoint_ticks, check_repeats,
)  # fmt: skip


def _by_joint(group: str, sensor: KindConfig, outline: RobotOutline) -> KindConfig | None:
    """Return the values of each joint's sensor, None without sensors; see values_by_joint."""
    return values_by_joint(group, sensor, outline.joint_units)


def _check_payload(robot: RobotConfig, mismatch: KindConfig) -> None:
    least = -robot.payload.mass
    if isinstance(mismatch, MismatchConfig) and mismatch.payload < least:
        raise ConfigError(
            f"mismatch.payload: {mismatch.payload:g} kg is less than nothing of the true payload, "
            f"robot.payload.mass with {-least:g} kg; allowed: {least:g} or more"
        )


def _check_commands(plant: PlantConfig, controller: ControllerConfig) -> None:
    given, taken = CONTROLLERS.commands(controller.kind), PLANTS.commands(plant.kind)
    if given == "torque" and taken == "position":
        fit = [kind for kind in PLANTS.names() if PLANTS.commands(kind) == "torque"]
        raise ConfigError(
            f"plant.kind: {plant.kind} follows joint positions, and {controller.kind} gives torques; take plant="
            f"{' or plant='.join(fit)}, or a controller that commands joint positions"
        )
    if given == "position" and taken == "torque" and options_of(plant).servo is None:
        raise ConfigError(
            f"plant.kind: {plant.kind} takes torques and has no servo, and {controller.kind} commands joint "
            "positions; take another plant or controller"
        )


def _check_mass(arm: Robot, plant: PlantConfig) -> None:
    """Reject torques on joints that move no mass: MuJoCo would move its minimum inertia instead."""
    model = arm.model
    bodies = zip(model.joint_names, list(model.pin_model.inertias)[1:], model.armature, strict=True)
    moved = [name for name, body, armature in bodies if armature or body.mass or body.inertia.any()]
    free = model.joint_names[model.joint_names.index(moved[-1]) + 1 :] if moved else model.joint_names
    if free and PLANTS.commands(plant.kind) == "torque":
        told = f"robot: no mass behind {few(free)}, so torques cannot move it; give the links there <inertial>"
        raise ConfigError(f"{told}, or take plant=kinematic controller=differential_inverse_kinematics")


def _ignores_base_rotation(arm: Robot, plant: PlantConfig) -> bool:
    return len(arm.stages) > 1 and options_of(plant).wrist_rotation == "parallel"


def _build_path(arm: Robot, trajectory: KindConfig, ignore_base_rotation: bool) -> Trajectory:
    """Return the desired motion, which starts at the tip position at home unless the config gives a start."""
    joints = TRAJECTORIES.joint_motion(trajectory, arm)
    if joints is not None:
        return TipOfJoints(arm, joints, ignore_base_rotation)
    start = trajectory.start if isinstance(trajectory, HasStart) else None
    place = end_points(arm, arm.home[None], ignore_base_rotation)[-1, 0] if start is None else np.array(start)
    return TRAJECTORIES.build(trajectory, place)
