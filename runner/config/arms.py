"""Rigid-body model from a robot's config: URDF and MJCF files, and arms mounted on each other."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.robot import ArmConfig, RobotConfig, StageConfig
from runner.robots.armature import armature_file
from runner.robots.description import find_file, find_urdf, mjcf_of, read_arm, read_urdf
from runner.robots.inertials import Payload, set_file
from runner.robots.joint_dynamics import dynamics_of
from runner.robots.mjcf_files import is_mjcf
from runner.robots.model import RobotModel
from runner.robots.mounting import Mount, mount
from runner.robots.robot import Robot, Stage
from runner.robots.tool_link import TOOL_TIP, ToolBody, mount_tool
from runner.schema.per_joint import expand
from runner.sensing.force_torque import ForceTorqueConfig

_KEPT = 8
_AT_LIMIT = 1e-9  # rad or m
_TURN = 2.0 * np.pi
_built: dict[tuple[object, ...], Robot] = {}


def build_robot(
    config: RobotConfig, gravity: float, config_dirs: Sequence[Path] = (), sensor: ForceTorqueConfig | None = None
) -> Robot:
    """Return the robot that a config describes; runs with equal files and values share it.

    Args:
        config: The robot's config.
        gravity: Magnitude of gravity along -z of the base, in m/s^2.
        config_dirs: Config folders of the user, searched for URDFs and MJCFs.
        sensor: Config of the force/torque sensor, whose mass loads the last arm's tip frame; None for no sensor.

    Raises:
        ConfigError: for a file that cannot be found or built, a frame or link that does not exist, a configuration or
            friction of the wrong length, a configuration beyond the joint limits, or names that clash between stages.
    """
    paths = [find_arm(key, arm, config_dirs) for key, arm in keyed_arms(config)]
    files = [
        file
        for path, arm in zip(paths, config.arms.values(), strict=True)
        for file in (*(mjcf_of(path).files if arm.mjcf else [path]), set_file(path), armature_file(path))
        if file.exists()
    ]
    key = (
        config.model_dump_json(),
        gravity,
        None if sensor is None else (sensor.mass, sensor.height),
        *((file, file.stat().st_mtime_ns, file.stat().st_size) for file in files),
    )
    if key not in _built:
        if len(_built) == _KEPT:
            _built.clear()
        _built[key] = _build(config, gravity, paths, sensor)
    return _built[key]


def build_loaded(
    config: RobotConfig, gravity: float, config_dirs: Sequence[Path] = (), sensor: ForceTorqueConfig | None = None
) -> tuple[tuple[float, Robot], ...]:
    """Return the time of each change of payload, in s, and the robot from then on; see build_robot."""
    changes = config.payload.schedule
    loads = [config.payload.model_copy(update={"mass": change.mass, "schedule": []}) for change in changes]
    robots = [build_robot(config.model_copy(update={"payload": load}), gravity, config_dirs, sensor) for load in loads]
    return tuple((change.at, robot) for change, robot in zip(changes, robots, strict=True))


def _build(config: RobotConfig, gravity: float, paths: Sequence[Path], sensor: ForceTorqueConfig | None) -> Robot:
    several = len(config.arms) > 1
    stages: list[Stage] = []
    whole, prefix, tip, first = "", "", "", 0
    for path, name, (key, arm) in zip(paths, config.arms, keyed_arms(config), strict=True):
        outermost = len(stages) + 1 == len(config.arms)
        payloads = _payloads(config, arm.tip, sensor) if outermost else []
        with _told_of(arm):
            urdf = read_urdf(path, arm.masses, arm.armature, arm.inertials, arm.velocity_limits, payloads)
            own_tip = arm.tip
            if outermost and config.tool is not None:
                urdf, own_tip = mount_tool(urdf, arm.tip, ToolBody(**config.tool.model_dump())), TOOL_TIP
            model = RobotModel(urdf, own_tip, gravity)
        base_frame = None
        if not stages:
            _refuse_mount(key, arm)
            whole, tip = urdf, own_tip
        else:
            below, prefix = prefix, f"{name}_"
            whole, base_frame = _mount(key, whole, urdf, below, prefix, arm)
            tip = prefix + own_tip
        joints = slice(first, first + model.nq)
        home = np.array(expand(f"{key}.home", arm.home, model.joint_names))
        _check_home(f"{key}.home", model, home)
        file = dynamics_of(read_arm(path), path.name, gravity)
        stages.append(Stage(name, model, urdf, joints, home, base_frame, file))
        first = joints.stop
    flange = prefix + list(config.arms.values())[-1].tip
    whole_model = RobotModel(whole, tip, gravity) if several else stages[0].model
    for kind, value in (("viscous", config.friction.viscous), ("coulomb", config.friction.coulomb)):
        expand(f"robot.friction.{kind}", value, whole_model.joint_names)
    return Robot(whole, whole_model, tuple(stages), flange)


def keyed_arms(config: RobotConfig) -> list[tuple[str, ArmConfig]]:
    """Return the arms of a robot, each with the key of its group."""
    several = len(config.arms) > 1
    return [(f"robot.stages.{name}" if several else "robot", arm) for name, arm in config.arms.items()]


def find_arm(key: str, arm: ArmConfig, config_dirs: Sequence[Path]) -> Path:
    """Return the file of an arm, in the format of its key.

    Raises:
        ConfigError: for no file or two, a file that does not exist, or an MJCF given as URDF.
    """
    if (arm.urdf is None) == (arm.mjcf is None):
        found = "neither" if arm.urdf is None else f"both, '{arm.urdf}' and '{arm.mjcf}'"
        raise ConfigError([f"{key}.urdf, {key}.mjcf: found {found}; give one file, and null for the other"])
    path = find_urdf(arm.urdf, config_dirs) if arm.urdf else find_file("robot.mjcf", str(arm.mjcf), config_dirs)
    if arm.urdf and is_mjcf(path):
        raise ConfigError([f"{key}.urdf: {path} is an MJCF; name it at {key}.mjcf"])
    return path


def sliding_joints(config: RobotConfig, config_dirs: Sequence[Path]) -> dict[str, dict[str, bool]]:
    """Return by stage and joint whether the files define the joint as prismatic."""
    trees = [read_arm(find_arm(key, arm, config_dirs)) for key, arm in keyed_arms(config)]
    return {
        name: {joint: tree.joints[joint].get("type") == "prismatic" for joint in tree.chain}
        for name, tree in zip(config.arms, trees, strict=True)
    }


def mixed_arms(resolved: Mapping[str, object], option: str, config_dirs: Sequence[Path]) -> Iterator[str]:
    """Yield a problem for each file of a built-in robot if a config folder has a file of the same name.

    Args:
        resolved: The config as plain data.
        option: The option chosen in the group robot.
        config_dirs: Config folders of the user.
    """
    option, robot = option.removesuffix(".yaml"), resolved.get("robot")
    if not (isinstance(robot, Mapping) and (conf_dir() / "robot" / f"{option}.yaml").is_file()):
        return
    stages = robot.get("stages")
    for arm in stages.values() if isinstance(stages, Mapping) else [robot]:
        name = arm.get("urdf") if isinstance(arm, Mapping) else None
        try:
            ours, found = (find_urdf(str(name), folders) for folders in ((), config_dirs))
        except ConfigError:
            continue  # validation reports it
        if found != ours:
            named = f"robot.urdf: '{name}' of robot={option} is one of ours"
            yield f"{named}, and {found} has the same name; rename that file, or choose the robot that it belongs to"


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


def _check_home(key: str, model: RobotModel, home: FloatArray) -> None:
    problems = []
    for name, unit, value, lower, upper in zip(
        model.joint_names, model.joint_units, home, *model.position_limits, strict=True
    ):
        if unit == "rad" and abs(value) > _TURN and lower <= value <= upper:
            problems.append(f"{key}: {name} at {value:g} rad is more than a whole turn; degrees? write {value:g}deg")
        if not lower - _AT_LIMIT <= value <= upper + _AT_LIMIT:
            turned = np.radians(value)
            degrees = unit == "rad" and abs(value) > _TURN and lower <= turned <= upper
            hint = f"; degrees? write {value:g}deg, which is {turned:.4g} rad" if degrees else ""
            problems.append(
                f"{key}: {name} at {value:g} {unit} is beyond its limits, {lower:.4g} to {upper:.4g} {unit}{hint}"
            )
    if problems:
        raise ConfigError(problems)


def _payloads(config: RobotConfig, flange: str, sensor: ForceTorqueConfig | None) -> list[Payload]:
    """Return the masses on the flange except the tool: the payload at the tip, and the force/torque sensor."""
    tip = np.zeros(3) if config.tool is None else np.array(config.tool.tip)
    payloads = [Payload(flange, config.payload.mass, (tip + config.payload.position).tolist())]
    if sensor is not None:
        payloads.append(Payload(flange, sensor.mass, (0.0, 0.0, 0.5 * sensor.height)))
    return payloads


def _mount(key: str, whole: str, urdf: str, below: str, prefix: str, arm: ArmConfig) -> tuple[str, str]:
    place = arm.mount if isinstance(arm, StageConfig) else None
    if place is None:
        raise ConfigError([f"{key}.mount: missing; a stage above the first needs frame, translation and rotation"])
    return mount(whole, urdf, prefix, Mount(below + place.frame, place.translation, place.rotation))


def _refuse_mount(key: str, arm: ArmConfig) -> None:
    if isinstance(arm, StageConfig) and arm.mount is not None:
        raise ConfigError([f"{key}.mount: the first stage is fixed to the ground; allowed: null"])
