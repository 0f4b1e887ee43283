"""Setting and signals of a run for the caveat rules."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.trace import Trace, Traces

if TYPE_CHECKING:
    from runner.config.robot import RobotConfig
    from runner.config.run import RunConfig
    from runner.controllers.sampled_stability import VelocityLoop
    from runner.metrics.caveats.time_constants import TimeConstant
    from runner.plants.servo_contact_stability import ServoContact
    from runner.robots.mismatch import MismatchConfig
    from runner.robots.model import RobotModel
    from runner.sensing import EncoderNoise


@dataclass(frozen=True)
class Setting:
    """The setting of a run.

    Attributes:
        repetitions: Number of repetitions.
        duration: Length of the run, in s.
        robot: Config of the robot, for its payload and rating.
        joint_names: Names of the joints.
        joint_units: Unit of each joint's position, rad or m.
        position_limits: Lower and upper position limits, shape (2, nq), in rad; infinite where there is none.
        torque_limits: Torque limit of each joint, shape (nq,), in N m; infinite where there is none.
        plant: Kind of the plant.
        torques: Whether controllers command torques, not joint positions.
        ticks_per_torque: Ticks for which a joint's torque is held, shape (nq,).
        tracked: Whether the tip is to follow a path, not to go to a goal in its own way.
        complies: True if the controller is to comply with the external wrench.
        noise: Noise of the joint measurement.
        mismatch: How what controllers believe of the robot differs from it.
        mass: Mass of all moving links, in kg.
        in_place_of: Kind of the default plant, where it is missing and this one stands in for it; else None.
        contact: Of an arm behind joint servos with a wall, under an admittance law; None where there is none.
        touch: How a small motion on a wall grows in a period of a law that pushes by torques; None where none does.
        velocity_loop: How near a velocity loop is to what its period bears; None where no law says its gain.
        slowest: The part of the laws that takes longest to do its work; None where no law says.
        left_out: What the robot's files hold that would change the motion and is not in the run, in words, by file.
    """

    repetitions: int
    duration: float
    robot: "RobotConfig"
    joint_names: Sequence[str]
    joint_units: Sequence[str]
    position_limits: FloatArray
    torque_limits: FloatArray
    plant: str
    torques: bool
    ticks_per_torque: NDArray[np.intp]
    tracked: bool
    complies: bool
    noise: "EncoderNoise"
    mismatch: "MismatchConfig"
    mass: float
    in_place_of: str | None
    contact: "ServoContact | None"
    touch: float | None
    velocity_loop: "VelocityLoop | None"
    slowest: "TimeConstant | None"
    left_out: Mapping[str, Sequence[str]]


def setting_of(config: "RunConfig", q_start: FloatArray | None = None) -> Setting:
    """Return the setting of a run.

    Args:
        config: The checked config.
        q_start: Joint positions at the start, shape (nq,), in rad; None leaves contact out, and takes home elsewhere.
    """
    from runner.controllers.sampled_stability import velocity_loop
    from runner.metrics.caveats.contact_stability import force_contact, servo_contact
    from runner.metrics.caveats.mjcf import left_out_of
    from runner.metrics.caveats.time_constants import slowest_part
    from runner.plants.kinds import IsFallback

    model = config.arm.model
    units, position_limits, mass = _of_model(model)
    ticks = np.ones(model.nq, dtype=np.intp)
    if config.commands == "torque":
        for loop in config.loops:
            ticks[loop.joints] = round(loop.period / config.timing.tick)
    return Setting(
        repetitions=config.settings.repetitions,
        duration=config.timing.ticks * config.timing.tick,
        robot=config.robot,
        joint_names=model.joint_names,
        joint_units=units,
        position_limits=position_limits,
        torque_limits=config.torque_limits,
        plant=config.plant.kind,
        torques=config.commands == "torque",
        ticks_per_torque=ticks,
        tracked=config.path.tracked,
        complies=config.environment.kind != "free" and any(loop.uses_wrench for loop in config.loops),
        noise=config.noise,
        mismatch=config.mismatch,
        mass=mass,
        in_place_of=config.plant.in_place_of if isinstance(config.plant, IsFallback) else None,
        contact=None if q_start is None or "wrist_sensor" in config.plugged else servo_contact(config, q_start),
        touch=None if q_start is None or "wrist_sensor" in config.plugged else force_contact(config, q_start),
        velocity_loop=velocity_loop(config.loops, config.arm, config.path) if config.commands == "torque" else None,
        slowest=slowest_part(config, q_start),
        left_out=left_out_of(config),
    )


@lru_cache(maxsize=8)  # as the runs of a sweep share their arm
def _of_model(model: "RobotModel") -> tuple[Sequence[str], FloatArray, float]:
    """Return joint units, position limits and mass of an arm."""
    return model.joint_units, model.position_limits, model.mass


@dataclass(frozen=True)
class Signals:
    """Signals and metrics of a run, a row for each control tick; axes of several runs may stand in front.

    Attributes:
        q: Joint positions, shape (..., T, nq), in rad.
        tau: Torques that were held, shape (..., T - 1, nq), in N m.
        tip: Tip positions, shape (..., T, 3), in m.
        desired: Desired tip positions, likewise.
        saturation: Share of the ticks that each joint is at its torque limit, shape (..., nq).
        limits: Torque limit of each joint, shape (..., nq), in N m; infinite where there is none.
    """

    q: FloatArray
    tau: FloatArray
    tip: FloatArray
    desired: FloatArray
    saturation: FloatArray
    limits: FloatArray

    def part(self, first: int, last: int) -> "Signals":
        """Return the runs on the first axis from one to before another."""
        return Signals(**{name: value[first:last] for name, value in vars(self).items()})


def signals_of(trace: Trace | Traces, metrics: Mapping[str, float | FloatArray | None]) -> Signals:
    """Return what rules look at in a run that did not fail, or in several, which then stand on the first axis.

    Args:
        trace: The run, or the runs.
        metrics: Its metrics, or arrays of theirs.
    """
    shares = [metrics[f"saturation_fraction_q{joint + 1}"] for joint in range(len(trace.joint_names))]
    tip = trace.end_points[-1]
    return Signals(
        q=trace.q,
        tau=trace.tau[..., :-1, :],
        tip=tip,
        desired=np.broadcast_to(trace.desired[..., 0, :], tip.shape),
        saturation=np.array(shares, dtype=np.float64).T,
        limits=trace.limits,
    )
