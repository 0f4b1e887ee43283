"""PyBullet availability, installed library versions and the default plant.

PyBullet is optional: Python 3.11 is the newest version with PyBullet wheels.
"""

import contextlib
import platform
from collections.abc import Iterable
from importlib.util import find_spec

_WHEELS = (3, 11)  # the newest Python for which there are wheels of PyBullet
STAND_IN = "mujoco_fallback"
"""Option of the group plant that takes bullet's place where PyBullet is missing."""


def has_pybullet() -> bool:
    """Tell whether PyBullet is installed."""
    return find_spec("pybullet") is not None


def installed_versions(names: Iterable[str]) -> dict[str, str]:
    """Return the versions of libraries by name; one that is not installed is left out."""
    from importlib.metadata import PackageNotFoundError, version  # half of the time in which a word is completed

    found = {}
    for name in names:
        with contextlib.suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def default_plant() -> str:
    """Return the option of the group plant for which `default` stands on this machine."""
    return "bullet" if has_pybullet() else STAND_IN


def bullet_missing() -> str:
    """Return what to do where bullet is asked for and PyBullet is missing."""
    found = platform.python_version_tuple()[:2]
    built = (
        ""
        if tuple(map(int, found)) <= _WHEELS
        else f", which builds it with a C++ compiler for some minutes: Python {'.'.join(found)} has no wheel of it, "
        f"{'.'.join(map(str, _WHEELS))} has"
    )
    return (
        "plant.kind: bullet needs PyBullet, which is not installed; take plant=mujoco, or install it by "
        f"`pip install pybullet`{built}"
    )
