"""Preview of a line of overrides, printed by `--dry-run`."""

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

from runner.base.sanitize import few, one_line
from runner.store.axes import SweepAxis, override_value

if TYPE_CHECKING:
    from runner.sweeps.plan import Plan
    from runner.sweeps.preview import Preview

_MOST_LISTED = 1000  # values of an axis that are read; a few are printed


def print_preview(plan: "Plan", found: "Preview", as_json: bool) -> None:
    """Print the axes and cells of a plan, which of them are stored, and the expected time.

    Args:
        plan: The plan.
        found: Its preview.
        as_json: True to print all cells as JSON.
    """
    grid = plan.whole.axes()
    entries = grid.entries if grid else []
    axes = [entry for entry in entries if isinstance(entry, SweepAxis)]
    shared = [entry for entry in entries if isinstance(entry, str)]
    if as_json:
        cells = [
            {"overrides": plan.overrides(cell), "run": name, "stored": bool(found.stored[cell])}
            for cell, name in enumerate(found.checked.names)
        ]
        known = {} if found.expected is None else {"seconds": found.expected.seconds, "known": found.expected.known}
        listed = [{"key": axis.key, "values": list(axis.values)} for axis in axes]
        print(json.dumps({"axes": listed, "shared": shared, "cells": cells, "cpu_time": known}, indent=1))
        return
    width = max((len(axis.key) for axis in axes), default=0)
    for axis in axes:
        values = few([override_value(value) for value in axis.values[:_MOST_LISTED]])
        print(one_line(f"{axis.key:{width}}  {len(axis.values)} values: {values}"))
    if shared:
        print(one_line(f"all cells: {' '.join(shared)}"))
    count, stored = len(plan), int(found.stored.sum())
    missing = f"{count - stored} to simulate, {found.duration}" if stored < count else "none to simulate"
    print(f"{count} cell{'s' if count > 1 else ''}, {stored} stored already, {missing}")
    for name, cell in (("first", 0), ("last", count - 1)) if axes else ():
        print(one_line(f"{name + ':':6} {_differing(plan.overrides(cell), shared)}"))
    print("dry run: nothing is simulated or stored")


def _differing(overrides: Sequence[str], shared: Sequence[str]) -> str:
    return " ".join(text for text in overrides if text not in shared)
