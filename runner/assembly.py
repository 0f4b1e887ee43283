"""From a checked config to the objects of a closed loop: the only place where a `kind:` becomes an object."""

import math

import numpy as np

from runner.config.per_joint import expand
from runner.config.per_stage import by_stage
from runner.config.run import RunConfig
from runner.controllers import CONTROLLERS
from runner.metrics import MetricContext
from runner.plants import PLANTS
from runner.robots.inverse_kinematics import solve_tip_position
from runner.robots.robot import end_points
from runner.sensing import JointEncoders
from runner.simulation import ClosedLoop
from runner.trace import FloatArray
from runner.trajectories import TRAJECTORIES


def assemble(config: RunConfig) -> ClosedLoop:
    """Make the closed loop that a config describes.

    Raises:
        ConfigError: where the start of the trajectory cannot be reached, or a part refuses its config.
    """
    arm, home = config.arm, config.arm.home
    parallel = config.parallel
    at_home = end_points(arm, home[None], parallel)[-1, 0]
    start = at_home if config.trajectory.start is None else np.array(config.trajectory.start)
    trajectory = TRAJECTORIES.build(config.trajectory, start)
    duration = trajectory.run_duration if config.settings.duration is None else config.settings.duration
    return ClosedLoop(
        robot=arm,
        plant=PLANTS.build(config.plant, arm, config.step, config.steps_per_tick),
        loops=CONTROLLERS.build(config.controller, arm),
        trajectory=trajectory,
        limits=_limits(config),
        tick=config.tick,
        ticks=math.ceil(duration / config.tick - 1e-9),
        q_start=_start_posture(config, start),
        parallel=parallel,
    )


def _limits(config: RunConfig) -> FloatArray:
    limits = config.torque_limits.max
    if limits is None:
        return np.full(config.arm.model.nq, math.inf)
    values = by_stage("torque_limits.max", limits, config.arm.stage_names)
    per_stage = [
        expand("torque_limits.max", value, stage.model.joint_names)
        for value, stage in zip(values, config.arm.stages, strict=True)
    ]
    return np.array([limit for stage in per_stage for limit in stage])


def _start_posture(config: RunConfig, start: FloatArray) -> FloatArray:
    """Return joint positions that bring the tip to a start: the first stage moves, riding ones stay at home."""
    arm = config.arm
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
    per_stage = by_stage("noise.position", noise.position, config.arm.stage_names)
    amplitudes = np.concatenate(
        [np.full(stage.model.nq, value) for value, stage in zip(per_stage, config.arm.stages, strict=True)]
    )
    return [
        JointEncoders(
            closed.ticks // closed.every(loop) + 1,
            loop.period,
            amplitudes,
            noise.distribution,
            noise.velocity,
            np.random.default_rng([config.settings.seed, repetition, place]),
        )
        for place, loop in enumerate(closed.loops)
    ]


def metric_context(config: RunConfig, closed: ClosedLoop) -> MetricContext:
    """Return what the metrics need to know of a run beside its trace."""
    reach = getattr(config.controller, "reach", None)
    return MetricContext(closed.trajectory, config.robot.settling_band, closed.tick, reach)
