"""Simulated arms: from torques to true motion."""

from runner.plants.plant import Plant
from runner.registry import Registry

PLANTS = Registry("plant", {"bullet": "runner.plants.bullet", "rk4": "runner.plants.rk4"})

__all__ = ["PLANTS", "Plant"]
