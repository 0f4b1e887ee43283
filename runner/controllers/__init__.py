"""Control laws: from time, measurement and reference to joint torques or positions."""

from runner.controllers.controller import Controller, Loop, PositionController
from runner.controllers.kinds import ControllerConfig, Controllers

CONTROLLERS = Controllers(
    {
        "admittance": "runner.controllers.admittance",
        "computed_torque": "runner.controllers.computed_torque",
        "differential_inverse_kinematics": "runner.controllers.differential_inverse_kinematics",
        "macro_mini": "runner.controllers.macro_mini",
        "operational_space": "runner.controllers.operational_space",
        "three_joint": "runner.controllers.three_joint",
        "whole_body": "runner.controllers.whole_body",
        "xarm7_as_printed": "runner.controllers.xarm7_as_printed",
    }
)

__all__ = ["CONTROLLERS", "Controller", "ControllerConfig", "Loop", "PositionController"]
