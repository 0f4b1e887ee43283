"""Versions of the libraries and engines from which the numbers of a run follow."""

import platform
from functools import cache, lru_cache

from runner.base.engines import installed_versions
from runner.plants.stepped_bullet import bullet_versions
from runner.symbolic.engine import evaluator

_LIBRARIES = ("arm-control-runner", "pybullet", "mujoco", "pin", "numpy", "scipy", "hydra-core")
_OWN = ("kinematic", "none", "rk4", "rk4_flexible_links")  # built-in plants without an external engine
_ENGINES = {"bullet": (), "mujoco": ("mujoco",), **dict.fromkeys(_OWN, ())}


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that results depend on."""
    return {"python": platform.python_version(), **installed_versions(_LIBRARIES), **evaluator()}


@lru_cache(maxsize=16)
def engine_versions(plant: str) -> dict[str, str]:
    """Return the versions of the engines that simulate a kind of plant; a plug-in plant may use any engine.

    Runs of plant=bullet have the same names with and without PyBullet; see bullet_versions.
    """
    used = _ENGINES.get(plant, ("mujoco", "pybullet"))
    own = bullet_versions() if plant == "bullet" else {}
    return installed_versions((*used, "pin")) | evaluator() | own


def has_compiler() -> bool:
    """Return True if the compiler of laws and runs is installed."""
    return bool(evaluator())
