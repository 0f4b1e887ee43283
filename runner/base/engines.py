"""Numerical engines: PyBullet availability, installed versions, and settings of the environment."""

import contextlib
import logging
import os
import platform
from collections.abc import Iterable
from importlib.util import find_spec

_WHEELS = (3, 11)  # newest Python version with PyBullet wheels


def has_pybullet() -> bool:
    """Return True if PyBullet is installed."""
    return find_spec("pybullet") is not None


def installed_versions(names: Iterable[str]) -> dict[str, str]:
    """Return the versions of installed libraries by name."""
    from importlib.metadata import PackageNotFoundError, version  # slow: half of the time of a shell completion

    found = {}
    for name in names:
        with contextlib.suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def bullet_missing() -> str:
    """Return the error message for plant=bullet where only PyBullet can move the arm, with a remedy."""
    found = platform.python_version_tuple()[:2]
    built = (
        ""
        if tuple(map(int, found)) <= _WHEELS
        else f", which builds it with a C++ compiler for some minutes: Python {'.'.join(found)} has no wheel of it, "
        f"{'.'.join(map(str, _WHEELS))} has"
    )
    return (
        "plant.kind: bullet needs PyBullet for this arm, which is not installed; take plant=mujoco, or install it by "
        f"`pip install pybullet`{built}"
    )


def quiet_environment() -> None:
    """Limit numerical libraries to one thread, and let Hydra raise exceptions unchanged; call before importing numpy.

    Matplotlib logs errors only: if the home folder is not writable, it would warn about each folder that it creates
    elsewhere. Pydantic would search every installed package for plug-ins to it.
    """
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ["HYDRA_FULL_ERROR"] = "1"
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
