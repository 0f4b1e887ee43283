"""From a checked config to the objects of a closed loop: the only place where a `kind:` becomes an object."""

import math
from typing import Any

import numpy as np

from runner.config.per_joint import expand
from runner.config.per_stage import by_stage
from runner.config.run import RunConfig
from runner.controllers import CONTROLLERS, Loop
from runner.controllers.admittance_stability import check_wall
from runner.environments import ENVIRONMENTS, Environment
from runner.environments.wall import Wall
from runner.errors import ConfigError
from runner.feasibility import check_path
from runner.guard.faults import find_fault
from runner.interaction import Interaction
from runner.metrics import MetricContext
from runner.plants import PLANTS, Plant, PositionPlant, innermost
from runner.plants.servo import JointServo
from runner.robots.inverse_kinematics import solve_tip_position
from runner.robots.mismatch import believe
from runner.robots.robot import Robot, end_points
from runner.robots.task_space import distance_beside
from runner.sensing import ForceTorqueSensor, JointEncoders
from runner.simulation import ClosedLoop
from runner.trace import FloatArray
from runner.trajectories import Trajectory

_BESIDE = 1e-9  # of the reach: farther beside the plane of a planar arm a path cannot be reached

_BELIEFS = 2**32 - 1  # in the seeds of what controllers believe; the loops' places count from 0


def assemble(config: RunConfig, repetition: int = 0) -> ClosedLoop:
    """Make the closed loop that a config describes.

    Controllers and servos get the arm as they believe it to be, in a repetition; plant, path and start are of the true
    one.

    Args:
        config: The checked config.
        repetition: Number of the repetition, of which the beliefs follow.

    Raises:
        ConfigError: where the start of the trajectory cannot be reached, joints that are told where to go cannot
            follow it, or a part refuses its config.
    """
    arm = config.arm
    trajectory = config.path
    _check_path_reach(config, trajectory)
    limits, q_start = _limits(config), _start_posture(config, trajectory.start)
    if CONTROLLERS.follows_paths(config.controller.kind):
        check_path(config.controller, arm, trajectory, q_start, config.robot.settling_band)
    environment: Environment | None = ENVIRONMENTS.build(config.environment)
    believed = _believe(config, repetition)
    loops: tuple[Loop, ...] = CONTROLLERS.build(config.controller, believed)
    plant = _make_plant(config, believed, limits)
    return ClosedLoop(
        robot=arm,
        plant=plant,
        loops=loops,
        trajectory=trajectory,
        limits=limits,
        tick=config.tick,
        ticks=config.ticks,
        commands=config.commands,
        interaction=_make_interaction(config, loops, environment, plant, trajectory.start),
        q_start=q_start,
        parallel=config.parallel,
        delay=config.delay,
    )


def _believe(config: RunConfig, repetition: int) -> Robot:
    """Return the robot as its controllers believe it to be."""
    generator = np.random.default_rng([config.settings.seed, repetition, _BELIEFS])
    return believe(config.arm, config.mismatch, np.array(config.robot.payload.position), generator)


def _check_path_reach(config: RunConfig, trajectory: Trajectory) -> None:
    model, times = config.arm.model, np.linspace(0.0, trajectory.duration, 1001)
    path = trajectory.sample(times)[:, 0]
    distance = np.linalg.norm(path - model.shoulder, axis=1)
    row = int(distance.argmax())
    if distance[row] > model.reach * (1.0 + 1e-12):
        raise ConfigError(
            [
                f"trajectory: at t = {times[row]:.4g} s the path lies {distance[row]:.4g} m from the shoulder, and the "
                f"arm reaches {model.reach:.4g} m: {distance[row] - model.reach:.4g} m too far; make it smaller, or "
                "start elsewhere"
            ]
        )
    beside = distance_beside(model, path)
    row = int(beside.argmax())
    if beside[row] > _BESIDE * model.reach:
        raise ConfigError(
            [
                f"trajectory: at t = {times[row]:.4g} s the path lies {beside[row]:.4g} m beside the plane or line in "
                "which alone the joints move the tip; take a path within it"
            ]
        )


def _make_plant(config: RunConfig, believed: Robot, limits: FloatArray) -> Plant | PositionPlant:
    arm = config.arm
    plant: Plant | PositionPlant
    if PLANTS.commands(config.plant.kind) == "position":
        plant = PLANTS.build(config.plant, arm, config.tick, round(config.controller.period / config.tick))
        return plant
    plant = PLANTS.build(config.plant, arm, config.step, config.steps_per_tick)
    if config.commands == "torque":
        return plant
    every = round(config.controller.period / config.tick)
    return JointServo(plant, believed.model, config.plant.servo, arm.home, limits, every, config.delay)


def _make_interaction(
    config: RunConfig, loops: tuple[Loop, ...], environment: Environment | None, plant: Any, start: FloatArray
) -> Interaction | None:
    """Return what the tip feels; a wall stands in the plant itself where that makes contacts."""
    within = innermost(plant)
    if isinstance(environment, Wall):
        tool = config.robot.tool
        if tool is None:
            raise ConfigError(["environment.kind: a wall is touched by the tip of a tool, and robot.tool is null"])
        _check_wall(config, environment)
        if hasattr(within, "add_wall"):
            environment.reset(start)
            ball = tool.tip_radius * environment.normal  # it is the ball's centre that is led
            wall = environment.config
            within.add_wall(environment.point - ball, environment.normal.copy(), wall.stiffness, wall.damping)
            environment = None
    elif environment is None and not any(loop.feels for loop in loops):
        return None
    return Interaction(config.arm, environment, config.tick)


def _check_wall(config: RunConfig, wall: Wall) -> None:
    if getattr(config.controller, "check_stability", False):
        delay = 0 if PLANTS.commands(config.plant.kind) == "position" else 1
        delay += math.ceil(config.delay * config.tick / config.controller.period - 1e-9)
        law, values = config.controller.law, wall.config
        check_wall(law, config.controller.period, values.stiffness, values.damping, delay)


def _limits(config: RunConfig) -> FloatArray:
    """Return the torque limits: those of the config, and the efforts of the URDF where they are smaller."""
    limits, efforts = config.torque_limits.max, config.arm.model.effort_limits
    if limits is None:
        return efforts
    values = by_stage("torque_limits.max", limits, config.arm.stage_names)
    per_stage = [
        expand("torque_limits.max", value, stage.model.joint_names)
        for value, stage in zip(values, config.arm.stages, strict=True)
    ]
    return np.minimum([limit for stage in per_stage for limit in stage], efforts)


def _start_posture(config: RunConfig, start: FloatArray) -> FloatArray:
    """Return joint positions that bring the tip to a start, as the controller wants it.

    Where it has no wish, the first stage moves and riding ones stay at home.
    """
    arm = config.arm
    try:
        wanted: FloatArray | None = CONTROLLERS.start_posture(config.controller, arm, start)
    except np.linalg.LinAlgError as error:
        raise ConfigError([f"trajectory.start: {error}"]) from error
    if wanted is not None:
        fault = find_fault(wanted, arm.home.shape)
        if fault:
            raise ConfigError([f"controller.kind: start_posture of '{config.controller.kind}' gave {fault}"])
        return np.array(wanted, dtype=np.float64)
    home = end_points(arm, arm.home[None], config.parallel)[:, 0]
    if np.array_equal(start, home[-1]):
        return arm.home
    if len(arm.stages) == 1 or not config.parallel:
        return solve_tip_position(arm.model, start, arm.home)
    first = arm.stages[0]
    return np.concatenate(
        [solve_tip_position(first.model, start - (home[-1] - home[0]), first.home), arm.home[first.joints.stop :]]
    )


def make_encoders(config: RunConfig, closed: ClosedLoop, repetition: int) -> list[JointEncoders]:
    """Make the joint measurement of each loop for one repetition.

    Its noise follows from (seed, repetition) and the loop's place alone: however long a run or another loop's period
    is, it starts alike, so that runs can be compared in pairs.
    """
    noise = config.noise
    amplitudes = _for_joints(config, "noise.position", noise.position)
    resolution = _for_joints(config, "noise.resolution", noise.resolution)
    return [
        JointEncoders(
            closed.ticks // closed.every(loop) + 1,
            loop.period,
            amplitudes,
            noise.distribution,
            noise.velocity,
            resolution,
            np.random.default_rng([config.settings.seed, repetition, place]),
        )
        for place, loop in enumerate(closed.loops)
    ]


def _for_joints(config: RunConfig, key: str, value: Any) -> FloatArray:
    """Return a value by stage for each joint, shape (nq,)."""
    stages = config.arm.stages
    values = by_stage(key, value, config.arm.stage_names)
    return np.concatenate([np.full(stage.model.nq, value) for stage, value in zip(stages, values, strict=True)])


def make_wrist_sensor(config: RunConfig, closed: ClosedLoop, repetition: int) -> ForceTorqueSensor | None:
    """Make the force/torque sensor for one repetition, where there is something to feel; noise as for the encoders."""
    if closed.interaction is None:
        return None
    generator = np.random.default_rng([config.settings.seed, repetition, len(closed.loops)])
    return ForceTorqueSensor(closed.ticks + 1, closed.tick, config.wrist_sensor, generator)


def metric_context(config: RunConfig, closed: ClosedLoop) -> MetricContext:
    """Return what the metrics need to know of a run beside its trace."""
    reach = getattr(config.controller, "reach", None)
    return MetricContext(closed.trajectory, config.robot.settling_band, closed.tick, reach)
