"""Numerical engines: PyBullet availability, installed versions, the default plant, and settings of the environment."""

import contextlib
import logging
import os
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
    """Return the versions of installed libraries by name."""
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


def quiet_environment() -> None:
    """Keep numerical libraries to one thread, and let Hydra's exceptions through; call before importing numpy.

    Matplotlib says its errors alone: in a home that cannot be written it warns of each folder that it makes elsewhere.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ["HYDRA_FULL_ERROR"] = "1"
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
