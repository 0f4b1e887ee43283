"""Stored part of one compared sweep and its caveats; a run counts as a sweep of one cell."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from runner.base.errors import StoreError
from runner.reporting.comparison.pairs import Cells
from runner.store import Finished, Run, Sweep, open_sweep
from runner.sweeps.measurements import Measurements, measure, measure_sweep, with_finer


@dataclass(frozen=True)
class Side:
    """A sweep, or a run as a sweep of one cell.

    Attributes:
        name: What it is called in the comparison, such as "A".
        folder: Its folder.
        command: The command that makes it.
        measurements: Its stored cells.
        missing: Number of cells that are not stored.
        damage: What is damaged of what is stored, a text for each file.
    """

    name: str
    folder: Path
    command: str
    measurements: Measurements
    missing: int = 0
    damage: Sequence[str] = ()

    @property
    def failed(self) -> int:
        """Number of cells that failed."""
        return sum(status != "ok" for status in self.measurements.statuses)

    def config_of_cells(self) -> Cells:
        """Return the place in `measurements.configs` of the config of each cell, shape (cells,)."""
        places = np.zeros(len(self.measurements.hashes), dtype=np.intp)
        for place, (_, cells) in enumerate(self.measurements.configs):
            places[cells] = place
        return places

    def resolved(self, key: str) -> list[Any]:
        """Return the resolved value of a dotted key in each config; a mapping of a group, None where there is none."""
        values = []
        for config, _ in self.measurements.configs:
            value: Any = config
            for part in key.split("."):
                value = value.get(part) if isinstance(value, dict) else None
            values.append(value)
        return values


def open_side(name: str, folder: Path) -> Side:
    """Open what is stored of a sweep, ended or not.

    Raises:
        StoreError: If the folder is no sweep, or none of its cells is stored.
        DamagedError: If it is damaged.
    """
    sweep = open_sweep(folder)
    part, damage = stored_part(sweep)
    if not len(part.hashes):
        raise StoreError(f"{folder}: none of its {len(sweep.hashes)} cells is stored; continue with: {sweep.command}")
    missing = len(sweep.hashes) - len(part.hashes)
    return Side(name, folder, sweep.command, measure_sweep(part), missing, damage)


def side_of_run(name: str, run: Run) -> Side:
    """Return a run as a sweep of one cell."""
    measured = with_finer(measure([()], [run]), run.folder.parent.parent)
    return Side(name, run.folder, str(run.provenance["command"]), measured)


def stored_part(sweep: Sweep) -> tuple[Sweep, Sequence[str]]:
    """Return a sweep with those of its cells that are stored, and what is damaged."""
    finished = Finished(sweep.outputs)
    ends = {name: finished.outcome(name) is not None for name in set(sweep.hashes)}
    if all(ends.values()):
        return sweep, finished.damage
    kept = [cell for cell, name in enumerate(sweep.hashes) if ends[name]]
    hashes = [sweep.hashes[cell] for cell in kept]
    return replace(sweep, overrides=[sweep.overrides[cell] for cell in kept], hashes=hashes), finished.damage


def letter(place: int) -> str:
    """Return what one of several folders is called: A, B, ..., Z, then its number."""
    return chr(ord("A") + place) if place < 26 else str(place + 1)


@dataclass(frozen=True)
class SideCaveat:
    """A rule that was sprung in a sweep.

    Attributes:
        side: Name of the sweep.
        rule: Name of the rule.
        count: Number of cells in which it was.
        cells: Number of cells that the sweep has.
        worst: What it found where it measured most.
    """

    side: str
    rule: str
    count: int
    cells: int
    worst: str


def caveats_of(side: Side) -> list[SideCaveat]:
    """Return the rules that were sprung in a sweep, those of most cells first."""
    sprung: dict[str, list[Mapping[str, Any]]] = {}
    for found in side.measurements.caveats:
        for caveat in found:
            sprung.setdefault(str(caveat["rule"]), []).append(caveat)
    cells = len(side.measurements.hashes)
    return [
        SideCaveat(side.name, rule, len(found), cells, str(max(found, key=lambda one: float(one["value"]))["text"]))
        for rule, found in sorted(sprung.items(), key=lambda item: -len(item[1]))
    ]
