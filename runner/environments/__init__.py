"""What the world does to the tip: pushes, walls, hands."""

from runner.environments.environment import Environment
from runner.guard import WatchedEnvironment
from runner.registry import KindConfig, Registry

ENVIRONMENTS = Registry[KindConfig, [], Environment | None](
    "environment",
    {
        "free": "runner.environments.free",
        "hand": "runner.environments.hand",
        "push": "runner.environments.push",
        "wall": "runner.environments.wall",
    },
    watch=WatchedEnvironment,
)

__all__ = ["ENVIRONMENTS", "Environment"]
