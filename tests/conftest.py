"""Setup of every test session: hypothesis' profile, its own cache folder, and time limits that only end hangs."""

import gc
import re
from typing import Any

import pytest
from hypothesis import settings
from support import compiled_once  # noqa: F401 - for what it sets

from runner.base.engines import quiet_environment

quiet_environment()

import numpy as np  # noqa: E402 - after the environment

from runner.base.engines import has_pybullet  # noqa: E402

_FIXTURES = [
    "cli",
    "cost",
    "installed",
    "own_parts",
    "processes",
    "recorded",
    "robots",
    "runs",
    "stored",
    "studies",
    "sweeps",
    "tab",
    "tuning",
]
pytest_plugins = ("support.engines", *(f"fixtures.{name}" for name in _FIXTURES))

_LONGEST_ID = 60  # characters of a case's name

settings.register_profile("runner", derandomize=True, deadline=None, max_examples=40)
settings.load_profile("runner")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip what needs PyBullet where it is not installed: what is marked so, and what has bullet for a parameter."""
    missing = pytest.mark.skip(reason="PyBullet is not installed")
    for item in () if has_pybullet() else items:
        given = getattr(item, "callspec", None)
        asked = given is not None and any(map(_names_bullet, given.params.values()))
        if asked or item.get_closest_marker("bullet"):
            item.add_marker(missing)


def _names_bullet(value: Any) -> bool:
    given = isinstance(value, str | tuple | list | dict)
    return given and re.search(r"\bbullet(_flexible)?\b", str(value)) is not None


def pytest_make_parametrize_id(val: Any, argname: str) -> str | None:
    """Name a case by its values, where pytest would show a bare number or the argument's name with a count."""
    if isinstance(val, bool | int | float):
        return f"{argname}={val}"
    if isinstance(val, set | frozenset):
        val = sorted(map(str, val))  # the same order in every process
    if isinstance(val, tuple | list | dict | np.ndarray):
        return re.sub(r"[\s'\[\](){}]+", " ", str(val)).strip()[:_LONGEST_ID] or f"no {argname}"
    name = getattr(val, "__name__", None)
    return None if name == "<lambda>" else name


def pytest_collection_finish() -> None:
    """Leave what lives as long as the process to no later look for garbage, and look for it less often."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
