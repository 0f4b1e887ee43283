"""Control laws: from time, measurement and reference to joint torques or positions."""

from runner.controllers.controller import Controller, Loop, PositionController
from runner.controllers.kinds import ControllerConfig, Controllers

CONTROLLERS = Controllers(
    {
        "adaptive": "runner.controllers.adaptive",
        "admittance": "runner.controllers.admittance",
        "computed_torque": "runner.controllers.computed_torque",
        "differential_inverse_kinematics": "runner.controllers.differential_inverse_kinematics",
        "hybrid_force": "runner.controllers.hybrid_force",
        "impedance": "runner.controllers.impedance",
        "iterative_learning": "runner.controllers.iterative_learning",
        "joint_pd": "runner.controllers.joint_pd",
        "joint_pid": "runner.controllers.joint_pid",
        "macro_mini": "runner.controllers.macro_mini",
        "motor_pd": "runner.controllers.motor_pd",
        "operational_space": "runner.controllers.operational_space",
        "passivity": "runner.controllers.passivity",
        "sliding_mode": "runner.controllers.sliding_mode",
        "whole_body": "runner.controllers.whole_body",
    }
)

__all__ = ["CONTROLLERS", "Controller", "ControllerConfig", "Loop", "PositionController"]
