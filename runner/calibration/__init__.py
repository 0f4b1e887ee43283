"""Calibration of tool and force/torque sensor, with a covariance for every estimate."""

from runner.calibration.gravity import GravityCalibration, WrenchCompensation, identify_gravity
from runner.calibration.orientations import choose_orientations
from runner.calibration.tool import REST, Motion, Tool
from runner.calibration.tool_centre_point import ToolCentrePoint, identify_tool_centre_point
from runner.calibration.tool_direction import ToolDirection, identify_tool_direction
from runner.calibration.uncertainty import Consistency, consistency, joint_deviation, pose_covariances

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
