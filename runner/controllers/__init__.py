"""Control laws: from time, measurement and reference to joint torques."""

from runner.controllers.controller import Controller, Loop
from runner.registry import Registry

CONTROLLERS = Registry(
    "controller",
    {
        "macro_mini": "runner.controllers.macro_mini",
        "operational_space": "runner.controllers.operational_space",
        "whole_body": "runner.controllers.whole_body",
    },
)

__all__ = ["CONTROLLERS", "Controller", "Loop"]
