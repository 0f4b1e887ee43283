"""A chapter of a work written as Markdown, with the functions of the work beside those that every chapter has."""

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from inspect import getmembers, isfunction, signature
from pathlib import Path
from types import ModuleType
from typing import Any

from runner.reporting.document import Section
from runner.reporting.prose import blocks, plots, read_chapter, signals, tables
from runner.store import Calibration, Run
from runner.works.grids import Grids

Runs = Mapping[str, Run]
Calibrations = Mapping[str, Calibration]
_FIGURES = "figures"  # the module whose functions all chapters of a work may call


def chapter(file: str, name: str) -> Callable[..., Section]:
    """Return what makes a chapter from a work's stored runs, and from its calibrations where it has some.

    It may call the functions of `figures.py` of the work and of the module that bears the chapter's name.

    Args:
        file: The `__file__` of a module of the work.
        name: Name of the chapter's file without `.md`.
    """
    path = Path(file).with_name(f"{name}.md")

    def make(runs: Runs, calibrations: Calibrations | None = None) -> Section:
        names = names_for(path, runs, calibrations or {})
        return read_chapter(f"{path.parent.name}/{path.name}", path.read_text(encoding="utf-8"), names)

    make.__name__ = name
    return make


def names_for(path: Path, runs: Runs, calibrations: Calibrations) -> dict[str, Any]:
    """Return what a chapter's file may call and read, by name."""
    grids = Grids(path.with_name("runs.yaml"))
    names: dict[str, Any] = {"level_of": grids.level, "value": grids.value}
    own = [stem for stem in (_FIGURES, path.stem) if path.with_name(f"{stem}.py").exists()]
    package = f"runner.works.{path.parent.name}"
    for module in (blocks, signals, tables, plots, *(import_module(f"{package}.{stem}") for stem in own)):
        names |= names_of(module, runs, calibrations)
    return names


def names_of(module: ModuleType, runs: Runs, calibrations: Calibrations) -> dict[str, Any]:
    """Return the public functions that a module defines, by name.

    To those that begin with `runs` the work's runs are given, to those that begin with `calibrations` these.
    """
    given = {"runs": runs, "calibrations": calibrations}
    found = {}
    for name, function in getmembers(module, isfunction):
        if function.__module__ == module.__name__ and not name.startswith("_"):
            first = next(iter(signature(function).parameters), "")
            found[name] = partial(function, given[first]) if first in given else function
    return found
