"""Plants (simulated arms): true motion from joint torques or commanded joint positions."""

from runner.plants.kinds import PlantConfig, Plants
from runner.plants.plant import (
    ContactPlant,
    Plant,
    PositionPlant,
    ReportsContact,
    TellsEndPoints,
    ToolReactionPlant,
    unwrapped,
)

PLANTS = Plants({name: f"{__name__}.{name}" for name in ("bullet", "kinematic", "mujoco", "rk4", "rk4_flexible_links")})

__all__ = [
    "PLANTS",
    "ContactPlant",
    "Plant",
    "PlantConfig",
    "PositionPlant",
    "ReportsContact",
    "TellsEndPoints",
    "ToolReactionPlant",
    "unwrapped",
]
