"""Validation of a composed config, with one message that lists all problems."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from runner.base.cache import Memory
from runner.base.errors import ConfigError
from runner.base.sanitize import few
from runner.config.arms import build_loaded, build_robot
from runner.config.compose.problems import Problems, require
from runner.config.computation import check_computation, computation_of, count_late
from runner.config.controller_wrappers import check_notch, check_observer
from runner.config.desired_motion import check_path, check_points, check_repeats, start_posture
from runner.config.flexibility import check_flexible_joints, check_flexible_links
from runner.config.groups import Groups, read_groups
from runner.config.input_shaper import shape
from runner.config.limits import check_memory
from runner.config.noise import NoiseConfig
from runner.config.payload import check_payload, check_schedule
from runner.config.plugin_groups import exact_encoders
from runner.config.run import RunConfig
from runner.config.sensors import check_reading, endpoint_ticks
from runner.config.timing import Timing, count_steps, count_ticks
from runner.config.torque_limits import TorqueLimitsConfig
from runner.controllers import CONTROLLERS, ControllerConfig, Loop
from runner.plants import PLANTS, PlantConfig
from runner.plants.kinds import HasServo, RotatesMountedBase
from runner.plugins.registry import KindConfig
from runner.robots.model import STANDARD_GRAVITY
from runner.robots.robot import Robot, end_points
from runner.trajectories import TRAJECTORIES, Trajectory
from runner.trajectories.joint_motion import TipOfJoints
from runner.trajectories.kinds import HasStart

_MEMORY = Memory(4096)


def validate(resolved: Mapping[str, object], config_dirs: Sequence[Path] = ()) -> RunConfig:
    """Check a composed config.

    What groups give is kept for configs that share them, as a sweep's cells do: they must not be changed.

    Args:
        resolved: The config as plain data, interpolations resolved.
        config_dirs: Config folders of the user's, in which URDFs are looked for.

    Raises:
        ConfigError: with every problem found: dotted key, value found, values allowed, nearest valid name.
    """
    problems = Problems(_MEMORY)
    groups = read_groups(resolved, problems)
    problems.recall(check_payload, groups.robot, groups.mismatch)
    gravity = STANDARD_GRAVITY if groups.settings is None else groups.settings.gravity
    made_of = (groups.robot, gravity, config_dirs, *([] if groups.wrist_sensor is None else [groups.wrist_sensor]))
    arm = problems.recall(build_robot, *made_of)
    noise = problems.recall(NoiseConfig.by_joint, groups.noise, arm)
    torque_limits = problems.recall(TorqueLimitsConfig.by_joint, groups.torque_limits, arm)
    problems.recall(check_points, arm, groups.trajectory)
    problems.recall(_check_commands, groups.plant, groups.controller)
    problems.recall(_check_mass, arm, groups.plant)
    steps = problems.recall(count_steps, arm, groups.plant, groups.controller)
    problems.report()
    # What follows is made from parts that are sound, each for itself. Parts of the user's may remember other runs.
    build_loops = problems.recall if CONTROLLERS.is_ours(require(groups.controller).kind) else problems.attempt
    build_path = problems.recall if TRAJECTORIES.is_ours(require(groups.trajectory).kind) else problems.attempt
    loaded = problems.recall(build_loaded, *made_of)
    ignore_base_rotation = problems.recall(_ignores_base_rotation, arm, groups.plant)
    path = build_path(_build_path, arm, groups.trajectory, ignore_base_rotation)
    loops = build_loops(CONTROLLERS.build_for, groups.controller, arm, isinstance(path, TipOfJoints))
    path = problems.attempt(_shape, groups, arm, path, loops)
    build_path(check_path, arm, path)
    ticks = problems.attempt(count_ticks, groups.settings, steps, path)
    late = problems.recall(count_late, groups.plant, loops)
    problems.report()
    return _checked(RunConfig(
        settings=require(groups.settings),
        robot=require(groups.robot),
        arm=require(arm),
        loaded=require(loaded),
        plant=require(groups.plant),
        controller=require(groups.controller),
        loops=require(loops),
        commands=CONTROLLERS.commands(require(groups.controller).kind),
        path=require(path),
        environment=require(groups.environment),
        noise=noise or exact_encoders(require(arm)),  # a plug-in's measure in its place
        torque_limits=require(torque_limits),
        wrist_sensor=require(groups.wrist_sensor),
        joint_torques=require(groups.joint_torque_sensor).by_joint(require(arm)),
        mismatch=require(groups.mismatch), endpoint_sensor=require(groups.endpoint_sensor),
        disturbance_observer=require(groups.disturbance_observer), notch=groups.notch,
        timing=Timing(*require(steps), require(late), computation_of(require(groups.plant)).is_even, require(ticks)),
        ignore_base_rotation=require(ignore_base_rotation),
        sweep=require(groups.sweep), limits=require(groups.limits),
        caveats=require(groups.caveats), spec=require(groups.spec),
        plugged=groups.plugged, resolved=resolved,
    ))  # fmt: skip


def _shape(groups: Groups, arm: Robot, path: Trajectory, loops: tuple[Loop, ...]) -> Trajectory:
    """Return the desired motion as an input shaper leaves it, if any; it starts where the motion itself does."""
    if groups.input_shaper is None:
        return path
    controller, plant = require(groups.controller), require(groups.plant)
    q = (
        path.q_start
        if isinstance(path, TipOfJoints)
        else start_posture(controller, arm, path.start, _ignores_base_rotation(arm, plant))
    )
    return shape(groups.input_shaper, plant, arm, path, q, loops)


def _checked(config: RunConfig) -> RunConfig:
    """Return a config after the checks of what only the whole of it tells."""
    check_schedule(config)
    check_computation(config)
    check_observer(config)
    check_notch(config)
    check_flexible_joints(config)
    check_flexible_links(config)
    check_reading(config)
    endpoint_ticks(config)
    check_repeats(config)
    check_memory(config.limits, config.arm, config.timing, config.settings.repetitions, config.has_contact)
    return config


def _check_commands(plant: PlantConfig, controller: ControllerConfig) -> None:
    given, taken = CONTROLLERS.commands(controller.kind), PLANTS.commands(plant.kind)
    if given == "torque" and taken == "position":
        fit = [kind for kind in PLANTS.names() if PLANTS.commands(kind) == "torque"]
        raise ConfigError(
            [
                f"plant.kind: {plant.kind} follows joint positions, and {controller.kind} gives torques; take plant="
                f"{' or plant='.join(fit)}, or a controller that commands joint positions"
            ]
        )
    if given == "position" and taken == "torque" and not isinstance(plant, HasServo):
        raise ConfigError(
            [
                f"plant.kind: {plant.kind} takes torques and has no servo, and {controller.kind} commands joint "
                "positions; take another plant or controller"
            ]
        )


def _check_mass(arm: Robot, plant: PlantConfig) -> None:
    """Refuse torques where there is nothing that they could move: MuJoCo would move its least inertia."""
    model = arm.model
    bodies = zip(model.joint_names, list(model.pin_model.inertias)[1:], model.armature, strict=True)
    moved = [name for name, body, armature in bodies if armature or body.mass or body.inertia.any()]
    free = model.joint_names[model.joint_names.index(moved[-1]) + 1 :] if moved else model.joint_names
    if free and PLANTS.commands(plant.kind) == "torque":
        told = f"robot: no mass behind {few(free)}, so torques cannot move it; give the links there <inertial>"
        raise ConfigError([f"{told}, or take plant=kinematic controller=differential_inverse_kinematics"])


def _ignores_base_rotation(arm: Robot, plant: PlantConfig) -> bool:
    turns = plant.wrist_rotation if isinstance(plant, RotatesMountedBase) else "real"
    return len(arm.stages) > 1 and turns == "parallel"


def _build_path(arm: Robot, trajectory: KindConfig, ignore_base_rotation: bool) -> Trajectory:
    """Return the desired motion, which starts at the tip of home where the config does not say."""
    joints = TRAJECTORIES.joint_motion(trajectory, arm)
    if joints is not None:
        return TipOfJoints(arm, joints, ignore_base_rotation)
    start = trajectory.start if isinstance(trajectory, HasStart) else None
    place = end_points(arm, arm.home[None], ignore_base_rotation)[-1, 0] if start is None else np.array(start)
    return TRAJECTORIES.build(trajectory, place)
