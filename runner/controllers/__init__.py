"""Control laws: from time, measurement and reference to joint torques."""

from runner.controllers.controller import Controller
from runner.registry import Registry

CONTROLLERS = Registry("controller", {"operational_space": "runner.controllers.operational_space"})

__all__ = ["CONTROLLERS", "Controller"]
