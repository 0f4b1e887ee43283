"""Simulated arms: from torques, or joint positions commanded, to true motion."""

from runner.guard import WatchedPlant
from runner.plants.plant import Plant, PositionPlant, innermost
from runner.registry import Registry

PLANTS = Registry(
    "plant",
    {"bullet": "runner.plants.bullet", "kinematic": "runner.plants.kinematic", "rk4": "runner.plants.rk4"},
    watch=WatchedPlant,
)

__all__ = ["PLANTS", "Plant", "PositionPlant", "innermost"]
