"""Outline and rigid-body model from a robot's config: URDF and MJCF files, and arms mounted on each other."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.config.robot import ArmConfig, RobotConfig, StageConfig
from runner.config.robot_files import find_arm, keyed_arms
from runner.config.torque_limits import TorqueLimitsConfig
from runner.plants.friction_law import joint_friction
from runner.plants.motor_limits import TorqueLimits
from runner.plugins.registry import KindConfig
from runner.robots.description import mjcf_of, read_arm, read_urdf, with_payloads
from runner.robots.elements import limit_of
from runner.robots.inertials import Payload, armature_file, set_file
from runner.robots.joint_dynamics import FileDynamics, dynamics_of
from runner.robots.model import RobotModel
from runner.robots.mounting import TOOL_TIP, mount, mount_tool
from runner.robots.robot import Robot, Stage, by_joint
from runner.robots.tree import UrdfTree, check_tip, tree_of
from runner.schema.values import MountConfig, expand
from runner.sensing.force_torque import ForceTorqueConfig

_KEPT = 8
_Files = tuple[tuple[Path, int, int], ...]  # with the time of the last change and the size of each
_AT_LIMIT = 1e-9  # rad or m
_TURN = 2.0 * np.pi
_outlines: dict[tuple[object, ...], "RobotOutline"] = {}


@dataclass(frozen=True)
class ArmOutline:
    """An arm as its config and its file describe it, without a rigid-body model.

    Attributes:
        name: Name of the stage.
        config: Its config.
        path: Its file.
        urdf: Text of its URDF, without payload and tool.
        prefix: Prefix of its names in the URDF of the whole robot.
        place: Its mount on the arm below; None for the first arm.
        joint_names: Names of its joints, from the base outwards.
        joint_units: Unit of each joint's position: rad, or m for a prismatic joint.
        effort_limits: Effort limit of each joint, in N m; infinite where there is none.
        home: Position of each joint at home, in rad.
    """

    name: str
    config: ArmConfig
    path: Path
    urdf: str
    prefix: str
    place: MountConfig | None
    joint_names: tuple[str, ...]
    joint_units: tuple[str, ...]
    effort_limits: tuple[float, ...]
    home: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class RobotOutline:
    """A robot as its config and its files describe it.

    Attributes:
        config: The robot's config.
        stages: The arms, from the base outwards.
    """

    config: RobotConfig
    stages: tuple[ArmOutline, ...]

    @property
    def stage_names(self) -> tuple[str, ...]:
        """Names of the stages."""
        return tuple(stage.name for stage in self.stages)

    @property
    def stage_joints(self) -> dict[str, tuple[str, ...]]:
        """Joint names of each stage."""
        return {stage.name: stage.joint_names for stage in self.stages}

    @property
    def joint_units(self) -> dict[str, dict[str, str]]:
        """Unit of the position of each joint by its name in the robot, by stage: rad, or m for a prismatic joint."""
        return {
            stage.name: {f"{stage.prefix}{name}": unit for name, unit in zip(*joints, strict=True)}
            for stage in self.stages
            for joints in [(stage.joint_names, stage.joint_units)]
        }

    @property
    def effort_limits(self) -> FloatArray:
        """Effort limit of each joint, shape (nq,), in N m; infinite where there is none."""
        return np.concatenate([stage.effort_limits for stage in self.stages])

    def torque_limits(self, limits: TorqueLimitsConfig) -> TorqueLimits:
        """Return the torque limits of each joint: the effort limit of its file if it is smaller than `limits.max`.

        Raises:
            ConfigError: for values that do not fit the robot's stages and joints, and a speed without a torque.
        """
        most = np.minimum(by_joint("torque_limits.max", limits.max, self.stage_joints), self.effort_limits)
        speed = by_joint("torque_limits.no_load_speed", limits.no_load_speed, self.stage_joints)
        joints = [joint for own in self.stage_joints.values() for joint in own]
        endless = [
            name for name, torque, own in zip(joints, most, speed, strict=True) if own < np.inf and torque == np.inf
        ]
        if endless:
            raise ConfigError(
                f"torque_limits.no_load_speed: needs a torque limit; none for {', '.join(endless)}. Set "
                "torque_limits.max"
            )
        return TorqueLimits(most, speed)


def read_outline(config: RobotConfig, config_dirs: Sequence[Path] = ()) -> RobotOutline:
    """Return the outline of a robot; runs with equal files and values share it.

    Args:
        config: The robot's config.
        config_dirs: Config folders of the user, searched for URDFs and MJCFs.

    Raises:
        ConfigError: for a file that cannot be found or read, a frame or link that does not exist, a configuration or
            friction of the wrong length, a configuration beyond the joint limits, a wrong mount, or
            names that clash between stages.
    """
    paths = [find_arm(key, arm, config_dirs) for key, arm in keyed_arms(config)]
    files = [_dated(path, arm) for path, arm in zip(paths, config.arms.values(), strict=True)]
    key = (config.model_dump_json(), *files)
    if key not in _outlines:
        if len(_outlines) == _KEPT:
            _outlines.clear()
        _outlines[key] = _read(config, paths, files)
    return _outlines[key]


def build_robot(outline: RobotOutline, gravity: float, sensor: KindConfig | None = None) -> Robot:
    """Return the robot of an outline; runs of the outline share it.

    Args:
        outline: The outline.
        gravity: Magnitude of gravity along -z of the base, in m/s^2.
        sensor: Config of the wrist sensor; the mass of the built-in one loads the last arm's tip frame.

    Raises:
        ConfigError: for an arm that cannot be built, or a tool or payload on a frame that is not a link.
    """
    return _build(outline, gravity, (sensor.mass, sensor.height) if isinstance(sensor, ForceTorqueConfig) else None)


def build_loaded(
    outline: RobotOutline, gravity: float, sensor: KindConfig | None = None
) -> tuple[tuple[float, Robot], ...]:
    """Return the time of each change of payload, in s, and the robot from then on; see build_robot."""
    config = outline.config
    found = []
    for change in config.payload.schedule:
        payload = config.payload.model_copy(update={"mass": change.mass, "schedule": []})
        loaded = replace(outline, config=config.model_copy(update={"payload": payload}))
        found.append((change.at, build_robot(loaded, gravity, sensor)))
    return tuple(found)


def _dated(path: Path, arm: ArmConfig) -> _Files:
    """Return the files of an arm, each with the time of its last change and its size."""
    files = (*(mjcf_of(path).files if arm.mjcf else [path]), set_file(path), armature_file(path))
    return tuple((file, file.stat().st_mtime_ns, file.stat().st_size) for file in files if file.exists())


def _read(config: RobotConfig, paths: Sequence[Path], files: Sequence[_Files]) -> RobotOutline:
    stages: list[ArmOutline] = []
    joints: list[str] = []
    whole = below = ""
    for path, dated, name, (key, arm) in zip(paths, files, config.arms, keyed_arms(config), strict=True):
        prefix, place = f"{name}_" if stages else "", _find_mount(key, arm, below, first=not stages)
        with _told_of(arm):
            masses, speeds = (tuple(values.items()) for values in (arm.masses, arm.velocity_limits))
            armature = tuple(arm.armature) if isinstance(arm.armature, list) else arm.armature
            urdf, tree = _read_arm(path, dated, masses, armature, arm.inertials, speeds)
            check_tip(arm.tip, [*tree.links, *tree.joints])
        whole = urdf if place is None else mount(whole, urdf, prefix, place)[0]
        chain = [tree.joints[joint] for joint in tree.chain]
        units = tuple("m" if joint.get("type") == "prismatic" else "rad" for joint in chain)
        home = expand(f"{key}.home", arm.home, tree.chain)
        limits = [(limit_of(joint, "lower"), limit_of(joint, "upper")) for joint in chain]
        _check_home(f"{key}.home", tree.chain, units, limits, home)
        efforts = tuple(limit_of(joint, "effort") for joint in chain)
        joints += [prefix + joint for joint in tree.chain]
        stages.append(ArmOutline(name, arm, path, urdf, prefix, place, tuple(tree.chain), units, efforts, tuple(home)))
        below = prefix
    joint_friction("robot.friction", config.friction, joints)
    return RobotOutline(config, tuple(stages))


@lru_cache(maxsize=_KEPT)
def _read_arm(
    path: Path,
    _: _Files,  # decides what the file holds
    masses: tuple[tuple[str, float], ...],
    armature: float | tuple[float, ...] | str,
    inertials: str | None,
    velocity_limits: tuple[tuple[str, float], ...],
) -> tuple[str, UrdfTree]:
    """Return the URDF of an arm with the changes of its config, as text and as a tree; see read_urdf."""
    urdf = read_urdf(path, dict(masses), armature, inertials, dict(velocity_limits))
    return urdf, tree_of(urdf, path)


@lru_cache(maxsize=_KEPT)
def _dynamics_in(path: Path, _: _Files, gravity: float) -> FileDynamics:
    return dynamics_of(read_arm(path), path.name, gravity)


@lru_cache(maxsize=_KEPT)
def _build(outline: RobotOutline, gravity: float, sensor: tuple[float, float] | None) -> Robot:
    config, last = outline.config, outline.stages[-1]
    stages: list[Stage] = []
    whole, tip, first = "", "", 0
    for arm in outline.stages:
        urdf, own_tip = arm.urdf, arm.config.tip
        with _told_of(arm.config):
            if arm is last:
                urdf = with_payloads(urdf, _payloads(config, own_tip, sensor))
                if config.tool is not None:
                    urdf, own_tip = mount_tool(urdf, own_tip, config.tool), TOOL_TIP
            model = RobotModel(urdf, own_tip, gravity)
        whole, base_frame = (urdf, None) if arm.place is None else mount(whole, urdf, arm.prefix, arm.place)
        tip, joints = arm.prefix + own_tip, slice(first, first + model.nq)
        file = _dynamics_in(arm.path, _dated(arm.path, arm.config), gravity)
        stages.append(Stage(arm.name, model, urdf, joints, np.array(arm.home), base_frame, file))
        first = joints.stop
    model = RobotModel(whole, tip, gravity) if len(stages) > 1 else stages[0].model
    return Robot(whole, model, tuple(stages), last.prefix + last.config.tip, tuple(config.payload.position))


@contextmanager
def _told_of(arm: ArmConfig) -> Iterator[None]:
    """Let errors in the URDF converted from an MJCF name the key of the MJCF."""
    try:
        yield
    except ConfigError as error:
        if arm.mjcf is None:
            raise
        told = [problem.replace("robot.urdf:", "robot.mjcf:", 1) for problem in error.problems]
        raise ConfigError(told, error.hint) from None


def _check_home(
    key: str,
    names: Sequence[str],
    units: Sequence[str],
    limits: Sequence[tuple[float, float]],
    home: Sequence[float],
) -> None:
    problems = []
    for name, unit, (lower, upper), value in zip(names, units, limits, home, strict=True):
        if unit == "rad" and abs(value) > _TURN and lower <= value <= upper:
            problems.append(f"{key}: {name} at {value:g} rad is more than a whole turn; degrees? write {value:g}deg")
        if not lower - _AT_LIMIT <= value <= upper + _AT_LIMIT:
            turned = math.radians(value)
            degrees = unit == "rad" and abs(value) > _TURN and lower <= turned <= upper
            hint = f"; degrees? write {value:g}deg, which is {turned:.4g} rad" if degrees else ""
            problems.append(
                f"{key}: {name} at {value:g} {unit} is beyond its limits, {lower:.4g} to {upper:.4g} {unit}{hint}"
            )
    if problems:
        raise ConfigError(problems)


def _payloads(config: RobotConfig, flange: str, sensor: tuple[float, float] | None) -> list[Payload]:
    """Return the payload at the tip, and the force/torque sensor on the flange from its mass and height."""
    tip = np.zeros(3) if config.tool is None else np.array(config.tool.tip)
    payloads = [Payload(flange, config.payload.mass, (tip + config.payload.position).tolist())]
    if sensor is not None:
        mass, height = sensor
        payloads.append(Payload(flange, mass, (0.0, 0.0, 0.5 * height)))
    return payloads


def _find_mount(key: str, arm: ArmConfig, below: str, first: bool) -> MountConfig | None:
    """Return the mount of an arm on the arm below, whose names have a prefix; None for the first arm."""
    place = arm.mount if isinstance(arm, StageConfig) else None
    if first and place is not None:
        raise ConfigError(f"{key}.mount: the first stage is fixed to the ground; allowed: null")
    if not first and place is None:
        raise ConfigError(f"{key}.mount: missing; a stage above the first needs frame, translation and rotation")
    return None if place is None else place.model_copy(update={"frame": below + place.frame})
