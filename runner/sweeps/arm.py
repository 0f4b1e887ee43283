"""Arm of a robot by its name, for commands that make no run of it."""

from collections.abc import Sequence
from pathlib import Path

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.robots.robot import Robot


def arm_of(robot: str, config_dirs: Sequence[Path] = ()) -> Robot:
    """Return the arm that a run with `robot=ROBOT` controls.

    Args:
        robot: Name of the robot.
        config_dirs: Config folders of the user.

    Raises:
        ConfigError: if the robot does not exist, or its config is not valid.
    """
    return validate(compose((f"robot={robot}",), config_dirs)).arm
