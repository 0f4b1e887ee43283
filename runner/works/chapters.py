"""A chapter of a work written as Markdown, with the functions of the work beside those that every chapter has."""

from collections.abc import Callable, Mapping
from functools import partial
from inspect import getmembers, isfunction, signature
from pathlib import Path
from types import ModuleType
from typing import Any

from runner.reporting.document import Section
from runner.reporting.prose import blocks, read_chapter
from runner.store import Run


def chapter(path: Path, *modules: ModuleType) -> Callable[[Mapping[str, Run]], Section]:
    """Return what makes a chapter from a work's stored runs.

    Args:
        path: Its file.
        modules: Modules of the work whose public functions it may call.
    """

    def make(runs: Mapping[str, Run]) -> Section:
        names: dict[str, Any] = {}
        for module in (blocks, *modules):
            names |= names_of(module, runs)
        return read_chapter(f"{path.parent.name}/{path.name}", path.read_text(encoding="utf-8"), names)

    make.__name__ = path.stem
    return make


def names_of(module: ModuleType, runs: Mapping[str, Run]) -> dict[str, Any]:
    """Return the public functions that a module defines, by name; to those that begin with `runs` these are given."""
    found = {}
    for name, function in getmembers(module, isfunction):
        if function.__module__ == module.__name__ and not name.startswith("_"):
            takes_runs = next(iter(signature(function).parameters), "") == "runs"
            found[name] = partial(function, runs) if takes_runs else function
    return found
