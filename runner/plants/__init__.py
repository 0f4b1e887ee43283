"""Plants (simulated arms): true motion from joint torques or commanded joint positions."""

from runner.plants.kinds import GUARD, PlantConfig, Plants
from runner.plants.plant import Plant, PositionPlant

PLANTS = Plants(
    "plant",
    {
        "bullet": "runner.plants.bullet",
        "kinematic": "runner.plants.kinematic",
        "mujoco": "runner.plants.mujoco",
        "rk4": "runner.plants.rk4",
        "rk4_flexible_links": "runner.plants.rk4_flexible_links",
    },
    GUARD,
)

__all__ = [
    "PLANTS",
    "Plant",
    "PlantConfig",
    "PositionPlant",
]
