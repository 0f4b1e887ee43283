"""Checked config of a calibration, with the arm and the procedure that the checks build."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from runner.assembly.arms import build_robot, read_outline
from runner.base.dotted_keys import split_override
from runner.base.errors import ConfigError, nearest
from runner.base.sanitize import quoted
from runner.calibration import CALIBRATIONS
from runner.calibration.gravity import Tool
from runner.calibration.procedure import Bench, Procedure
from runner.config.calibration import CalibrationSettings
from runner.config.composed import Composed
from runner.config.parsing import Problems, group_of, parse, parse_kind, parse_robot, require
from runner.config.robot import RobotConfig
from runner.plugins.registry import KindConfig
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.sensing.force_torque import ForceTorqueConfig

_KEYS = (*CalibrationSettings.model_fields, "robot", "wrist_sensor", "calibration")


@dataclass(frozen=True)
class CalibrationConfig:
    """A calibration's config in which every check has passed.

    Attributes:
        settings: The keys at the root.
        robot: Config of the robot.
        arm: The robot.
        procedure: The calibration procedure.
        composed: The composed config that was checked.
        resolved: The part of it that a calibration reads, as plain data.
    """

    settings: CalibrationSettings
    robot: RobotConfig
    arm: Robot
    procedure: Procedure
    composed: Composed
    resolved: Mapping[str, object]


def validate_calibration(composed: Composed) -> CalibrationConfig:
    """Check a composed calibration and build its procedure.

    Raises:
        ConfigError: with every problem found: dotted key, value found, values allowed, nearest valid name.
    """
    problems = Problems()
    problems.attempt(_check_keys, composed)
    resolved = {key: value for key, value in composed.resolved.items() if key in _KEYS}
    root = {key: resolved.get(key) for key in CalibrationSettings.model_fields}
    settings = problems.attempt(parse, "", CalibrationSettings, root)
    robot = problems.attempt(parse_robot, problems.attempt(group_of, "robot", resolved))
    keys = problems.attempt(group_of, "wrist_sensor", resolved)
    sensor = problems.attempt(_parse_sensor, keys)
    keys = problems.attempt(group_of, CALIBRATIONS.group, resolved)
    calibration = cast("KindConfig | None", problems.attempt(parse_kind, CALIBRATIONS, keys))
    outline = problems.attempt(read_outline, robot, composed.config_dirs)
    arm = problems.attempt(lambda outline, settings: build_robot(outline, settings.gravity, sensor), outline, settings)
    bench = None if calibration is None else problems.attempt(_make_bench, robot, arm, sensor)
    procedure = problems.attempt(CALIBRATIONS.build, calibration, bench)
    problems.report()
    return CalibrationConfig(require(settings), require(robot), require(arm), require(procedure), composed, resolved)


def _check_keys(composed: Composed) -> None:
    """Reject overrides without effect: of keys that do not exist, or that only runs have."""
    given = [split_override(override)[0] for override in composed.overrides]
    unread = [key for key in given if key.partition(".")[0] not in _KEYS]
    if unread:
        raise ConfigError(
            f"{key}: a calibration reads no such key{nearest(key, _KEYS)}; keys: {', '.join(_KEYS)}" for key in unread
        )


def _parse_sensor(keys: Mapping[str, object]) -> ForceTorqueConfig:
    if "kind" in keys:
        raise ConfigError(
            "wrist_sensor.kind: a calibration supports only the built-in force/torque sensor; found the plug-in "
            f"{quoted(keys['kind'])}; take wrist_sensor=ideal or wrist_sensor=mini40"
        )
    return parse("wrist_sensor", ForceTorqueConfig, keys)


def _make_bench(robot: RobotConfig, arm: Robot, sensor: ForceTorqueConfig) -> Bench:
    tool = robot.tool
    if tool is None:
        raise ConfigError("robot.tool: found null; a calibration needs a tool: mass, centre_of_mass, inertia, tip, ...")
    return Bench(
        flange=RobotModel(arm.urdf, arm.flange, -float(arm.model.gravity[2])),
        home=arm.home,
        tip=np.array(tool.tip),
        tool=Tool(tool.mass, np.array(tool.centre_of_mass), np.diag(tool.inertia)),
        sensor=sensor,
        period=min(robot.period.values()) if isinstance(robot.period, dict) else robot.period,
    )
