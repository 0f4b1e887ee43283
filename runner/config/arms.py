"""From a robot's config to its rigid-body model: reading URDFs and mounting arms on each other."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from runner.config.per_joint import expand
from runner.config.robot import ArmConfig, RobotConfig, StageConfig
from runner.errors import ConfigError
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel
from runner.robots.mounting import Mount, mount
from runner.robots.robot import Robot, Stage


def build_robot(config: RobotConfig, gravity: float, config_dirs: Sequence[Path] = ()) -> Robot:
    """Return the robot that a config describes.

    Args:
        config: The robot's config.
        gravity: Magnitude of gravity along -z of the base, in m/s^2.
        config_dirs: Config folders of the user's, in which URDFs are looked for.

    Raises:
        ConfigError: for a URDF that cannot be found or built, a frame or link that does not exist, a posture of the
            wrong length, or names that clash between stages.
    """
    several = len(config.arms) > 1
    stages: list[Stage] = []
    whole, prefix, tip, first = "", "", "", 0
    for name, arm in config.arms.items():
        key = f"robot.stages.{name}" if several else "robot"
        urdf = read_urdf(find_urdf(arm.urdf, config_dirs), arm.masses, arm.rotor_inertia)
        model = RobotModel(urdf, arm.tip, gravity)
        base_frame = None
        if not stages:
            _refuse_mount(key, arm)
            whole, tip = urdf, arm.tip
        else:
            below, prefix = prefix, f"{name}_"
            whole, base_frame = _mount(key, whole, urdf, below, prefix, arm)
            tip = prefix + arm.tip
        joints = slice(first, first + model.nq)
        home = np.array(expand(f"{key}.home", arm.home, model.joint_names))
        stages.append(Stage(name, model, urdf, joints, home, base_frame))
        first = joints.stop
    return Robot(whole, RobotModel(whole, tip, gravity) if several else stages[0].model, tuple(stages))


def _mount(key: str, whole: str, urdf: str, below: str, prefix: str, arm: ArmConfig) -> tuple[str, str]:
    place = arm.mount if isinstance(arm, StageConfig) else None
    if place is None:
        raise ConfigError([f"{key}.mount: missing; a stage above the first needs frame, translation and rotation"])
    return mount(whole, urdf, prefix, Mount(below + place.frame, place.translation, place.rotation))


def _refuse_mount(key: str, arm: ArmConfig) -> None:
    if isinstance(arm, StageConfig) and arm.mount is not None:
        raise ConfigError([f"{key}.mount: the first stage stands on the ground; allowed: null"])
