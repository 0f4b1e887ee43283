"""Calibration of tool and force/torque sensor, with a covariance for every estimate."""

from runner.calibration.compensation import WrenchCompensation
from runner.calibration.consistency import Consistency, consistency
from runner.calibration.gravity import GravityCalibration, identify_gravity
from runner.calibration.orientations import choose_orientations
from runner.calibration.repeatability import joint_deviation, pose_covariances
from runner.calibration.tool import REST, Motion, Tool
from runner.calibration.tool_centre_point import ToolCentrePoint, identify_tool_centre_point
from runner.calibration.tool_direction import ToolDirection, identify_tool_direction

__all__ = [
    "REST",
    "Consistency",
    "GravityCalibration",
    "Motion",
    "Tool",
    "ToolCentrePoint",
    "ToolDirection",
    "WrenchCompensation",
    "choose_orientations",
    "consistency",
    "identify_gravity",
    "identify_tool_centre_point",
    "identify_tool_direction",
    "joint_deviation",
    "pose_covariances",
]
