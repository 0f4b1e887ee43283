"""Environments: external forces, walls and human guidance at the tip, and plug-in loads on links and joints."""

from runner.environments.environment import Environment, LoadsJoints, PushesLinks
from runner.plugins.guard import watch_environment
from runner.plugins.registry import KindConfig, Registry

ENVIRONMENTS = Registry[KindConfig, [], Environment | None](
    "environment",
    {
        "free": "runner.environments.free",
        "hand_guiding": "runner.environments.hand",
        "push": "runner.environments.push",
        "wall": "runner.environments.wall",
    },
    watch=watch_environment,
)

__all__ = ["ENVIRONMENTS", "Environment", "LoadsJoints", "PushesLinks"]
