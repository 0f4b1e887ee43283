"""Robot files that the config of a robot names."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.robot import ArmConfig, RobotConfig
from runner.robots.description import find_file, find_urdf, read_arm
from runner.robots.tree import is_mjcf


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
        raise ConfigError(f"{key}.urdf, {key}.mjcf: found {found}; give one file, and null for the other")
    path = find_urdf(arm.urdf, config_dirs) if arm.urdf else find_file("robot.mjcf", str(arm.mjcf), config_dirs)
    if arm.urdf and is_mjcf(path):
        raise ConfigError(f"{key}.urdf: {path} is an MJCF; name it at {key}.mjcf")
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
