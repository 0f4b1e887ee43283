"""Rotors that turn with the motors of flexible joints instead of their links."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import cast

from runner.config.arms import find_arm, keyed_arms
from runner.config.robot import RobotConfig
from runner.errors import ConfigError
from runner.plants import PlantConfig
from runner.plants.kinds import MayBend
from runner.registry import StrictModel
from runner.robots.description import read_arm
from runner.robots.rotors import rotor_inertias


def with_rotors_at_motors(
    robot: RobotConfig, plant: PlantConfig, config_dirs: Sequence[Path]
) -> tuple[RobotConfig, PlantConfig]:
    """Return a robot and its plant with the rotors of flexible joints as their motors, where these are not named.

    They are `robot.rotor_inertia`, as the joint feels them, so behind the gear. Rotors of rigid joints stay on their
    links.

    Raises:
        ConfigError: for a flexible joint without motor and rotor, and as build_robot.
    """
    joints = plant.flexible_joints if isinstance(plant, MayBend) else None
    if joints is None or joints.motor_inertia is not None:
        return robot, plant
    motors: dict[str, list[float | None]] = {}
    left: dict[str, list[float]] = {}
    problems = []
    for name, (key, arm) in zip(robot.arms, keyed_arms(robot), strict=True):
        path = find_arm(key, arm, config_dirs)
        rotors = rotor_inertias(read_arm(path), path, arm.rotor_inertia)
        given = joints.stiffness.get(name) if isinstance(joints.stiffness, Mapping) else joints.stiffness
        springs = given if isinstance(given, list) else [given] * len(rotors)
        if len(springs) != len(rotors):
            return robot, plant  # which is told of the stiffness
        parts = list(zip(rotors.items(), springs, strict=True))
        problems += [
            f"plant.flexible_joints.motor_inertia: null takes {key}.rotor_inertia, which is 0 for {joint}; give "
            "one of both"
            for (joint, rotor), spring in parts
            if spring is not None and not rotor
        ]
        motors[name] = [None if spring is None else rotor for (_, rotor), spring in parts]
        left[name] = [rotor if spring is None else 0.0 for (_, rotor), spring in parts]
    if problems:
        raise ConfigError(problems)
    several = len(motors) > 1
    bent = joints.model_copy(update={"motor_inertia": motors if several else next(iter(motors.values()))})
    plain = {name: arm.model_copy(update={"rotor_inertia": left[name]}) for name, arm in robot.arms.items()}
    stripped = robot.model_copy(update={"stages": plain}) if several else next(iter(plain.values()))
    return cast(RobotConfig, stripped), cast(
        PlantConfig, cast(StrictModel, plant).model_copy(update={"flexible_joints": bent})
    )
