"""Controllers: joint torques or positions from time, measurement and reference."""

from runner.controllers.controller import Controller, Loop, PositionController
from runner.controllers.kinds import ControllerConfig, Controllers, guard_loops

CONTROLLERS = Controllers(
    "controller",
    {
        "adaptive": "runner.controllers.joint_space.adaptive",
        "admittance": "runner.controllers.force.admittance",
        "computed_torque": "runner.controllers.joint_space.computed_torque",
        "differential_inverse_kinematics": "runner.controllers.kinematic.differential_inverse_kinematics",
        "hybrid_force": "runner.controllers.force.hybrid_force",
        "impedance": "runner.controllers.force.impedance",
        "iterative_learning": "runner.controllers.joint_space.iterative_learning",
        "joint_pd": "runner.controllers.joint_space.joint_pd",
        "joint_pid": "runner.controllers.joint_space.joint_pid",
        "macro_mini": "runner.controllers.macro_mini.macro_mini",
        "motor_pd": "runner.controllers.joint_space.motor_pd",
        "operational_space": "runner.controllers.operational_space.operational_space",
        "passivity": "runner.controllers.joint_space.passivity",
        "sliding_mode": "runner.controllers.joint_space.sliding_mode",
        "whole_body": "runner.controllers.operational_space.whole_body",
    },
    guard_loops,
)

__all__ = ["CONTROLLERS", "Controller", "ControllerConfig", "Loop", "PositionController"]
