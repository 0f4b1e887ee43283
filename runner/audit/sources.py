"""Where the equations of a published work are: its entries, and the functions that its entries name."""

import importlib
from pathlib import Path
from typing import Any

from runner.paths import works_dir

_FOLDER = "equations"


def sources() -> tuple[str, ...]:
    """Return the names of the works whose equations are audited."""
    return tuple(sorted(path.parents[1].name for path in works_dir().glob(f"*/{_FOLDER}/inventory.yaml")))


def folder(source: str) -> Path:
    """Return the folder of a work's entries."""
    return works_dir() / source / _FOLDER


def truth_of(source: str, name: str) -> Any:
    """Return the function or Truth that "module.name" stands for, of a module of the work's `equations/truths`."""
    return _resolve(source, "truths", name)


def rollout_of(source: str, name: str) -> Any:
    """Return the function that "module.name" stands for, of a module of the work's `equations/rollouts`."""
    return _resolve(source, "rollouts", name)


def _resolve(source: str, kind: str, name: str) -> Any:
    module, attribute = name.split(".")
    return getattr(importlib.import_module(f"runner.works.{source}.{_FOLDER}.{kind}.{module}"), attribute)
