"""Control laws: from time, measurement and reference to joint torques or positions."""

from runner.controllers.controller import Controller, Loop, PositionController
from runner.guard import watch_loops
from runner.registry import Registry

CONTROLLERS = Registry(
    "controller",
    {
        "admittance": "runner.controllers.admittance",
        "computed_torque": "runner.controllers.computed_torque",
        "differential_inverse_kinematics": "runner.controllers.differential_inverse_kinematics",
        "macro_mini": "runner.controllers.macro_mini",
        "operational_space": "runner.controllers.operational_space",
        "three_joint": "runner.controllers.three_joint",
        "whole_body": "runner.controllers.whole_body",
        "xarm7_as_printed": "runner.controllers.xarm7_as_printed",
    },
    watch=watch_loops,
)

__all__ = ["CONTROLLERS", "Controller", "Loop", "PositionController"]
