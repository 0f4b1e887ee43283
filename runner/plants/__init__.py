"""Simulated arms: from torques, or joint positions commanded, to true motion."""

from runner.plants.kinds import PlantConfig, Plants
from runner.plants.plant import ContactPlant, Plant, PositionPlant, ToolReactionPlant, innermost

PLANTS = Plants({"bullet": "runner.plants.bullet", "kinematic": "runner.plants.kinematic", "rk4": "runner.plants.rk4"})

__all__ = ["PLANTS", "ContactPlant", "Plant", "PlantConfig", "PositionPlant", "ToolReactionPlant", "innermost"]
