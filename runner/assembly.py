"""From a checked config to the objects of a closed loop: the only place where a `kind:` becomes an object."""

import math

import numpy as np

from runner.config.per_joint import expand
from runner.config.run import RunConfig
from runner.controllers import CONTROLLERS
from runner.metrics import MetricContext
from runner.plants import PLANTS
from runner.plants.plant import Arm
from runner.robots import solve_tip_position
from runner.sensing import JointEncoders
from runner.simulation import ClosedLoop
from runner.trajectories import TRAJECTORIES


def assemble(config: RunConfig) -> ClosedLoop:
    """Make the closed loop that a config describes.

    Raises:
        ConfigError: where the start of the trajectory cannot be reached, or a part refuses its config.
    """
    model = config.model
    home = np.array(config.robot.home)
    start = model.tip_position(home) if config.trajectory.start is None else np.array(config.trajectory.start)
    trajectory = TRAJECTORIES.build(config.trajectory, start)
    limits = math.inf if config.torque_limits.max is None else config.torque_limits.max
    period = config.controller.period
    duration = trajectory.run_duration if config.settings.duration is None else config.settings.duration
    return ClosedLoop(
        model=model,
        plant=PLANTS.build(config.plant, Arm(config.urdf, model), config.step, config.steps_per_tick),
        controller=CONTROLLERS.build(config.controller, model),
        trajectory=trajectory,
        limits=np.array(expand("torque_limits.max", limits, model.joint_names)),
        period=period,
        ticks=math.ceil(duration / period - 1e-9),
        q_start=solve_tip_position(model, start, home),
    )


def make_encoders(config: RunConfig, loop: ClosedLoop, repetition: int) -> JointEncoders:
    """Make the joint measurement of one repetition; its noise follows from (seed, repetition) alone."""
    noise = config.noise
    generator = np.random.default_rng([config.settings.seed, repetition])
    return JointEncoders(
        loop.ticks + 1, loop.model.nq, loop.period, noise.position, noise.distribution, noise.velocity, generator
    )


def metric_context(config: RunConfig, loop: ClosedLoop) -> MetricContext:
    """Return what the metrics need to know of a run beside its trace."""
    return MetricContext(loop.trajectory, config.robot.settling_band, loop.period)
