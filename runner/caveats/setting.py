"""Setting and signals of a run for the caveat rules."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.trace import Trace

if TYPE_CHECKING:
    from runner.assembly.run_config import RunConfig
    from runner.caveats.servo_contact_stability import ServoContact
    from runner.caveats.time_constants import TimeConstant
    from runner.config.robot import RobotConfig
    from runner.controllers.stability import VelocityLoop
    from runner.robots.mismatch import MismatchConfig
    from runner.robots.model import RobotModel

IDEAL = "kinematic"
"""Plant with ideal joint motion; forces have no effect on it."""


@dataclass(frozen=True)
class RunSetting:
    """Setting of a run.

    Attributes:
        repetitions: Number of repetitions.
        duration: Duration of the run, in s.
        robot: Config of the robot, for its payload and rating.
        joint_names: Names of the joints.
        joint_units: Unit of the position of each joint, rad or m.
        position_limits: Lower and upper position limits, shape (2, nq), in rad; infinite without a limit.
        velocity_limits: Speed limit of each joint, shape (nq,), in rad/s; infinite without a limit.
        torque_limits: Torque limit of each joint at rest, shape (nq,), in N m; infinite without a limit.
        speed_limits_torque: True if a torque limit depends on the speed.
        plant: Kind of the plant.
        stops: True if the plant stops joints at their position limits, with some compliance.
        torques: True if controllers command torques instead of joint positions.
        ticks_per_torque: Number of ticks for which the torque of each joint is constant, shape (nq,).
        tracked: True if the tip must follow a path, instead of only reaching a goal.
        complies: True if the controller must comply with the external wrench.
        noise: Largest noise or resolution of a measured joint position, in rad; None if velocities are not exact, or
            for encoders of another kind.
        mismatch: Factors on the nominal model of the controllers; None for a mismatch of another kind.
        mass: Mass of all moving links, in kg.
        contact: Contact of a servo-driven arm with a wall under an admittance law; None without one.
        touch: Growth factor of a small motion on a wall in a period of a hybrid force law; None without one.
        velocity_loop: Velocity gain relative to the stability limit of its period; None if no gain is known.
        slowest: Slowest part of the control laws; None if no time constant is known.
        left_out: Messages about contents of the robot's files that would change the motion and are missing, by file.
    """

    repetitions: int
    duration: float
    robot: "RobotConfig"
    joint_names: Sequence[str]
    joint_units: Sequence[str]
    position_limits: FloatArray
    velocity_limits: FloatArray
    torque_limits: FloatArray
    speed_limits_torque: bool
    plant: str
    stops: bool
    torques: bool
    ticks_per_torque: NDArray[np.intp]
    tracked: bool
    complies: bool
    noise: float | None
    mismatch: "MismatchConfig | None"
    mass: float
    contact: "ServoContact | None"
    touch: float | None
    velocity_loop: "VelocityLoop | None"
    slowest: "TimeConstant | None"
    left_out: Mapping[str, Sequence[str]]


def setting_of(config: "RunConfig", q_start: FloatArray | None = None) -> RunSetting:
    """Return the setting of a run.

    Args:
        config: The checked config.
        q_start: Joint positions at the start, shape (nq,), in rad. None leaves out contact and otherwise uses the home
            configuration.
    """
    from runner.caveats.contact_stability import force_contact, servo_contact
    from runner.caveats.time_constants import slowest_part
    from runner.controllers.stability import velocity_loop
    from runner.plants import PLANTS

    model = config.arm.model
    units, position_limits, mass = _of_model(model)
    ticks = np.ones(model.nq, dtype=np.intp)
    if config.commands == "torque":
        for loop in config.loops:
            ticks[loop.joints] = round(loop.period / config.timing.tick)
    return RunSetting(
        repetitions=config.settings.repetitions,
        duration=config.timing.ticks * config.timing.tick,
        robot=config.robot,
        joint_names=model.joint_names,
        joint_units=units,
        position_limits=position_limits,
        velocity_limits=model.velocity_limits,
        torque_limits=config.torque_limits.max,
        speed_limits_torque=config.torque_limits.depend_on_speed,
        plant=config.plant.kind,
        stops=PLANTS.features(config.plant.kind).STOPS,
        torques=config.commands == "torque",
        ticks_per_torque=ticks,
        tracked=config.path.tracked,
        complies=config.environment.kind != "free" and any(loop.uses_wrench for loop in config.loops),
        noise=_noise_beside_exact(config),
        mismatch=config.model_error,
        mass=mass,
        contact=None if q_start is None else servo_contact(config, q_start),
        touch=None if q_start is None else force_contact(config, q_start),
        velocity_loop=velocity_loop(config.loops, config.arm, config.path) if config.commands == "torque" else None,
        slowest=slowest_part(config, q_start),
        left_out=_left_out_of(config),
    )


def _noise_beside_exact(config: "RunConfig") -> float | None:
    noise = config.encoder_noise
    if noise is None or noise.velocity != "exact":
        return None
    drawn = 0.0 if noise.distribution == "none" else max(noise.position.tolist())
    return float(max(drawn, *noise.resolution.tolist()))


def _left_out_of(config: "RunConfig") -> Mapping[str, Sequence[str]]:
    """Return messages, by robot file, about contents that would change the motion and are missing in the run.

    Damping, friction and armature of a joint in the file count if the value of the joint in the run is zero. The
    mapping is empty for the kinematic plant.
    """
    from runner.assembly.flexibility import find_flexibility
    from runner.plants.decoupled import TorquePlantConfig
    from runner.plants.friction_law import joint_friction
    from runner.robots.joint_dynamics import by_value

    arm, plant = config.arm, config.plant
    if plant.kind == IDEAL:
        return {}
    viscous, coulomb = np.zeros((2, arm.model.nq))
    if isinstance(plant, TorquePlantConfig):
        friction = joint_friction("plant.friction", plant.friction, arm.model.joint_names)
        viscous, coulomb = np.array([friction.viscous, friction.coulomb])
    flexibility = find_flexibility(config)
    armature = arm.model.armature
    if flexibility is not None:
        armature = np.maximum(armature, flexibility.motors)
    found = {}
    for stage in arm.stages:
        if stage.file is None:
            continue
        parts = list(stage.file.left_out)
        for (what, key, held), given in zip(stage.file.by_key(), (viscous, coulomb, armature), strict=True):
            lost = np.where(given[stage.joints] == 0.0, held, 0.0)
            if lost.any():
                parts.append(f"{what} ({key}): {by_value(lost, stage.model.joint_names)}")
        if parts:
            found[stage.file.file] = parts
    return found


@lru_cache(maxsize=8)  # the runs of a sweep share their arm
def _of_model(model: "RobotModel") -> tuple[Sequence[str], FloatArray, float]:
    """Return the joint units, position limits and mass of an arm."""
    return model.joint_units, model.position_limits, model.mass


@dataclass(frozen=True)
class RunSignals:
    """Signals and metrics of a run, with one row for each control tick; leading axes are for several runs.

    Attributes:
        q: Joint positions, shape (..., T, nq), in rad.
        dq: Joint velocities, shape (..., T, nq), in rad/s.
        tau: Torques applied between the ticks, shape (..., T - 1, nq), in N m.
        tip: Tip positions, shape (..., T, 3), in m.
        desired: Desired tip positions, shape (..., T, 3), in m.
        saturation: Fraction of ticks at which each joint is at its torque limit, shape (..., nq).
        limits: Torque limit of each joint, shape (..., nq), in N m; infinite without a limit.
    """

    q: FloatArray
    dq: FloatArray
    tau: FloatArray
    tip: FloatArray
    desired: FloatArray
    saturation: FloatArray
    limits: FloatArray

    def part(self, first: int, last: int) -> "RunSignals":
        """Return the runs on the first axis from index `first` to before `last`."""
        return RunSignals(**{name: value[first:last] for name, value in vars(self).items()})


def signals_of(trace: Trace, metrics: Mapping[str, float | FloatArray | None]) -> RunSignals:
    """Return the signals for the rules, of a run that did not fail or of several such runs on the first axis.

    Args:
        trace: The trace of the run or runs.
        metrics: The metrics of the run, or arrays of metrics of the runs.
    """
    shares = [metrics[f"saturation_fraction_q{joint + 1}"] for joint in range(len(trace.joint_names))]
    tip = trace.tip
    return RunSignals(
        q=trace.q,
        dq=trace.dq,
        tau=trace.tau[..., :-1, :],
        tip=tip,
        desired=np.broadcast_to(trace.desired[..., 0, :], tip.shape),
        saturation=np.array(shares, dtype=np.float64).T,
        limits=trace.limits,
    )
