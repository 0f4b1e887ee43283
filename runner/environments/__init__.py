"""Environments: external forces, walls and human guidance at the tip, and plug-in loads on links and joints."""

from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.environments.environment import Environment
from runner.plugins.guard import Asked, Attribute, Guard, Method, array, find_fault, like, refuse
from runner.plugins.registry import KindConfig, Registry


def _check_points(points: Any, _: Asked) -> dict[str, FloatArray]:
    """Return the checked points of an environment by link."""
    found = dict(points)
    for link, point in found.items():
        if fault := find_fault(point, (3,)):
            raise ConfigError(f"environment.kind: its point on {quoted(link)} is {fault}")
    return {str(link): np.array(point, dtype=np.float64) for link, point in found.items()}


_GUARD = Guard(
    "environment",
    Environment,
    begin=Method(optional=True),
    reset=Method(),
    wrench=Method(array(6)),
    points=Attribute(_check_points, optional=True, fail=refuse),
    link_forces=Method(like(1), optional=True),
    joint_torques=Method(like(1), optional=True),
)

ENVIRONMENTS = Registry[KindConfig, [], Environment | None](
    "environment",
    {
        "free": "runner.environments.free",
        "hand_guiding": "runner.environments.hand",
        "push": "runner.environments.push",
        "wall": "runner.environments.wall",
    },
    _GUARD,
)

__all__ = ["ENVIRONMENTS", "Environment"]
