"""The groups of a run's config: which model each has, and all of them read."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

from runner.config.caveats import CaveatsConfig
from runner.config.limits import LimitsConfig
from runner.config.noise import NoiseConfig
from runner.config.parsing import parse, parse_group, parse_kind, parse_robot
from runner.config.preset import PresetConfig
from runner.config.problems import Problems
from runner.config.robot import OneArmConfig, RobotConfig
from runner.config.settings import RunSettings
from runner.config.sweep import SweepConfig
from runner.config.torque_limits import TorqueLimitsConfig
from runner.controllers import CONTROLLERS, ControllerConfig
from runner.environments import ENVIRONMENTS
from runner.errors import ConfigError, nearest
from runner.plants import PLANTS, PlantConfig
from runner.registry import KindConfig, Kinds, StrictModel
from runner.robots.mismatch import MismatchConfig
from runner.sensing import ForceTorqueConfig
from runner.trajectories import TRAJECTORIES

GROUPS: Mapping[str, Kinds | type[StrictModel]] = {
    **{kinds.group: kinds for kinds in (PLANTS, CONTROLLERS, TRAJECTORIES, ENVIRONMENTS)},
    "noise": NoiseConfig,
    "torque_limits": TorqueLimitsConfig,
    "wrist_sensor": ForceTorqueConfig,
    "mismatch": MismatchConfig,
    "robot": OneArmConfig,
    "preset": PresetConfig,
    "sweep": SweepConfig,
    "limits": LimitsConfig,
    "caveats": CaveatsConfig,
}
_SETTINGS = tuple(RunSettings.model_fields)


@dataclass(frozen=True)
class Groups:
    """The groups of a config, each checked for itself; None for one with a problem.

    Attributes:
        settings: The keys at the root.
        plant: Config of the plant, of the model that its kind names.
        controller: Config of the controller, likewise.
        trajectory: Config of the trajectory, likewise.
        environment: Config of the world around the tip, likewise.
        noise: Config of the joint measurement.
        torque_limits: Config of the torque limits.
        wrist_sensor: Config of the force/torque sensor.
        mismatch: How what the controllers believe of the robot differs from it.
        robot: Config of the robot.
        sweep: How a sweep that the run is part of is run.
        limits: What a command may cost.
        caveats: When a run tells that its result may mislead.
    """

    settings: RunSettings | None
    plant: PlantConfig | None
    controller: ControllerConfig | None
    trajectory: KindConfig | None
    environment: KindConfig | None
    noise: NoiseConfig | None
    torque_limits: TorqueLimitsConfig | None
    wrist_sensor: ForceTorqueConfig | None
    mismatch: MismatchConfig | None
    robot: RobotConfig | None
    sweep: SweepConfig | None
    limits: LimitsConfig | None
    caveats: CaveatsConfig | None


def read_groups(resolved: Mapping[str, object], problems: Problems) -> Groups:
    """Return the groups of a config.

    Args:
        resolved: The config as plain data, interpolations resolved.
        problems: Takes what is wrong.
    """
    problems.attempt(_check_keys, resolved)
    settings = {key: resolved.get(key) for key in _SETTINGS}
    problems.attempt(parse_group, "preset", PresetConfig, resolved)  # its values have been taken by other groups
    return Groups(
        settings=problems.attempt(parse, "", RunSettings, settings),
        plant=cast("PlantConfig | None", problems.attempt(parse_kind, PLANTS, resolved)),
        controller=cast("ControllerConfig | None", problems.attempt(parse_kind, CONTROLLERS, resolved)),
        trajectory=cast("KindConfig | None", problems.attempt(parse_kind, TRAJECTORIES, resolved)),
        environment=cast("KindConfig | None", problems.attempt(parse_kind, ENVIRONMENTS, resolved)),
        noise=problems.attempt(parse_group, "noise", NoiseConfig, resolved),
        torque_limits=problems.attempt(parse_group, "torque_limits", TorqueLimitsConfig, resolved),
        wrist_sensor=problems.attempt(parse_group, "wrist_sensor", ForceTorqueConfig, resolved),
        mismatch=problems.attempt(parse_group, "mismatch", MismatchConfig, resolved),
        robot=problems.attempt(parse_robot, resolved),
        sweep=problems.attempt(parse_group, "sweep", SweepConfig, resolved),
        limits=problems.attempt(parse_group, "limits", LimitsConfig, resolved),
        caveats=problems.attempt(parse_group, "caveats", CaveatsConfig, resolved),
    )


def _check_keys(resolved: Mapping[str, object]) -> None:
    known = (*_SETTINGS, *GROUPS)
    unknown = [str(key) for key in resolved if key not in known]
    if unknown:
        raise ConfigError(f"{key}: unknown key{nearest(key, known)}; keys: {', '.join(known)}" for key in unknown)
