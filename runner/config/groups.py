"""Config groups of a run, and the model of each."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

from runner.base.errors import ConfigError, nearest
from runner.config.caveats import CaveatsConfig
from runner.config.compose.problems import Problems
from runner.config.input_shaper import InputShaperConfig
from runner.config.limits import LimitsConfig
from runner.config.noise import NoiseConfig
from runner.config.parsing import group_of, parse, parse_kind, parse_robot
from runner.config.plugin_groups import GroupReader
from runner.config.preset import PresetConfig
from runner.config.robot import OneArmConfig, RobotConfig
from runner.config.settings import RunSettings
from runner.config.spec import SpecConfig
from runner.config.sweep import SweepConfig
from runner.config.torque_limits import TorqueLimitsConfig
from runner.controllers import CONTROLLERS, ControllerConfig
from runner.controllers.disturbance_observer import DisturbanceObserverConfig
from runner.controllers.notch import NotchConfig
from runner.environments import ENVIRONMENTS
from runner.plants import PLANTS, PlantConfig
from runner.plugins.registry import KindConfig, Kinds
from runner.robots.mismatch import MismatchConfig
from runner.schema.model import StrictModel
from runner.sensing import EndpointSensorConfig, ForceTorqueConfig, JointTorqueConfig
from runner.trajectories import TRAJECTORIES

GROUPS: Mapping[str, Kinds | type[StrictModel]] = {
    **{kinds.group: kinds for kinds in (PLANTS, CONTROLLERS, TRAJECTORIES, ENVIRONMENTS)},
    "noise": NoiseConfig,
    "torque_limits": TorqueLimitsConfig,
    "wrist_sensor": ForceTorqueConfig,
    "joint_torque_sensor": JointTorqueConfig,
    "endpoint_sensor": EndpointSensorConfig,
    "mismatch": MismatchConfig,
    "disturbance_observer": DisturbanceObserverConfig,
    "input_shaper": InputShaperConfig,
    "notch": NotchConfig,
    "robot": OneArmConfig,
    "preset": PresetConfig,
    "sweep": SweepConfig,
    "limits": LimitsConfig,
    "caveats": CaveatsConfig,
    "spec": SpecConfig,
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
        joint_torque_sensor: Config of the torque sensors in the joints.
        endpoint_sensor: Config of the sensor of the tip's position.
        mismatch: How what the controllers believe of the robot differs from it.
        disturbance_observer: Config of the observer that control laws carry.
        input_shaper: Config of what shapes the desired motion; None where nothing does.
        notch: Config of the notch in the torques; None where there is none.
        robot: Config of the robot.
        sweep: How a sweep that the run is part of is run.
        limits: What a command may cost.
        caveats: When a run tells that its result may mislead.
        spec: Bounds on metrics.
        plugged: Configs of plug-ins in place of ours, by group; see GroupReader.
    """

    settings: RunSettings | None
    plant: PlantConfig | None
    controller: ControllerConfig | None
    trajectory: KindConfig | None
    environment: KindConfig | None
    noise: NoiseConfig | None
    torque_limits: TorqueLimitsConfig | None
    wrist_sensor: ForceTorqueConfig | None
    joint_torque_sensor: JointTorqueConfig | None
    endpoint_sensor: EndpointSensorConfig | None
    mismatch: MismatchConfig | None
    disturbance_observer: DisturbanceObserverConfig | None
    input_shaper: InputShaperConfig | None
    notch: NotchConfig | None
    robot: RobotConfig | None
    sweep: SweepConfig | None
    limits: LimitsConfig | None
    caveats: CaveatsConfig | None
    spec: SpecConfig | None
    plugged: Mapping[str, KindConfig]


def read_groups(resolved: Mapping[str, object], problems: Problems) -> Groups:
    """Return the groups of a config; one that was read before, the same object, is not read again.

    Args:
        resolved: The config as plain data, interpolations resolved.
        problems: Takes what is wrong.
    """

    def read_kind(kinds: Kinds) -> StrictModel | None:
        return problems.recall(parse_kind, kinds, problems.attempt(group_of, kinds.group, resolved))

    problems.attempt(_check_keys, resolved)
    reader = GroupReader(problems, resolved)
    settings = {key: resolved.get(key) for key in _SETTINGS}
    reader.read(PresetConfig, "preset")  # its values have been taken by other groups
    return Groups(
        settings=problems.attempt(parse, "", RunSettings, settings),
        plant=cast("PlantConfig | None", read_kind(PLANTS)),
        controller=cast("ControllerConfig | None", read_kind(CONTROLLERS)),
        trajectory=cast("KindConfig | None", read_kind(TRAJECTORIES)),
        environment=cast("KindConfig | None", read_kind(ENVIRONMENTS)),
        noise=reader.read(NoiseConfig, "noise"),
        torque_limits=reader.read(TorqueLimitsConfig, "torque_limits"),
        wrist_sensor=reader.read(ForceTorqueConfig, "wrist_sensor"),
        joint_torque_sensor=reader.read(JointTorqueConfig, "joint_torque_sensor"),
        endpoint_sensor=reader.read(EndpointSensorConfig, "endpoint_sensor"),
        mismatch=reader.read(MismatchConfig, "mismatch"),
        disturbance_observer=reader.read(DisturbanceObserverConfig, "disturbance_observer"),
        input_shaper=reader.read(InputShaperConfig, "input_shaper") if "input_shaper" in resolved else None,
        notch=reader.read(NotchConfig, "notch") if "notch" in resolved else None,
        robot=problems.recall(parse_robot, problems.attempt(group_of, "robot", resolved)),
        sweep=reader.read(SweepConfig, "sweep"),
        limits=reader.read(LimitsConfig, "limits"),
        caveats=reader.read(CaveatsConfig, "caveats"),
        spec=reader.read(SpecConfig, "spec"),
        plugged=reader.plugged,
    )


def _check_keys(resolved: Mapping[str, object]) -> None:
    known = (*_SETTINGS, *GROUPS)
    unknown = [str(key) for key in resolved if key not in known]
    if unknown:
        raise ConfigError(f"{key}: unknown key{nearest(key, known)}; keys: {', '.join(known)}" for key in unknown)
