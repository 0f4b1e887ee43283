"""Measurements of stored runs in arrays, read run by run or a shard at once."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.metrics.caveats import changes_since
from runner.store import Run
from runner.store.shards import open_row
from runner.sweeps.differing import Resolver
from runner.sweeps.shard_columns import Columns, read_shard

Cells = NDArray[np.intp]


class Gathered:
    """What the cells of a sweep measured.

    Args:
        cells: Number of cells.

    Attributes:
        hashes: Name of each cell's run.
        failures: When, where and why each cell failed; empty for a good one.
        seeds: Seed of each cell, shape (cells,).
        units: Unit of each metric.
        provenance: What made the runs, each with its distinct values as texts.
        caveats: Why the result of each cell may not be what it seems.
        changes: With what else than today caveats were looked for, each with the number of cells.
        configs: Each resolved config with the cells that have it; those of a shard may differ in their seed.
    """

    def __init__(self, cells: int) -> None:
        self.hashes = [""] * cells
        self.failures = [""] * cells
        self.seeds = np.zeros(cells, dtype=np.int64)
        self.units: dict[str, str] = {}
        self.provenance: dict[str, dict[str, None]] = {}
        self.caveats: list[Sequence[Mapping[str, Any]]] = [()] * cells
        self.changes: Counter[str] = Counter()
        self.configs: list[tuple[Mapping[str, Any], list[Cells]]] = []
        self._places: dict[object, int] = {}  # of configs, by what tells them apart
        self._values: dict[str, FloatArray] = {}
        self._measured = np.zeros(cells, dtype=bool)
        self._resolver = Resolver()

    def add_run(self, cell: int, run: Run) -> None:
        """Take the run of a cell."""
        self.hashes[cell], self.failures[cell], self.caveats[cell] = run.hash, run.failure_text, run.caveats
        self.seeds[cell] = int(run.provenance["seed"])
        self.changes.update(changes_since(run.caveat_rules))
        self._note(run)
        for name, metric in run.metrics.items():
            own = run.values(name)
            row = np.where(np.isnan(own), np.inf, own)
            self._put(name, str(metric["unit"]), np.array([cell]), row[None])
        self.configs.append((self._resolver.resolve(run), [np.array([cell])]))

    def add_shard(self, path: Path, rows: Cells, cells: Cells) -> None:
        """Take runs of a shard.

        Args:
            path: The shard.
            rows: Its rows to take, shape (n,).
            cells: The cell of each, shape (n,).

        Raises:
            DamagedError: if it is damaged.
        """
        found = read_shard(path, rows)
        if found is None:
            for row, cell in zip(rows.tolist(), cells.tolist(), strict=True):
                self.add_run(cell, open_row(path, row))
            return
        self.seeds[cells] = found.seeds
        for place, cell in enumerate(cells.tolist()):
            self.hashes[cell], self.failures[cell] = found.names[place], found.failures[place]
            self.caveats[cell] = found.caveats[place]
        for rules, count in found.rules:
            self.changes.update(dict.fromkeys(changes_since(rules), count))
        for key, members in found.settings.items():
            if key not in self._places:
                run = open_row(path, int(rows[members[0]]))
                self._note(run)
                self._places[key] = len(self.configs)
                self.configs.append((self._resolver.resolve(run), []))
            self.configs[self._places[key]][1].append(cells[members])
        for name, texts in found.made_by.items():
            self.provenance.setdefault(name, {}).update(dict.fromkeys(texts))
        self._take_metrics(found, cells)

    def _take_metrics(self, found: Columns, cells: Cells) -> None:
        for name, (unit, members, values) in found.metrics.items():
            self._put(name, unit, cells[members], values)

    def _note(self, run: Run) -> None:
        """Take note of what made a run."""
        record = run.provenance
        pairs = [
            ("plant", f"{run.config['plant']['kind']}, step {record['plant_step']:g} s"),
            ("commit", commit_text(record["commit"])),
            ("seed", str(record["seed"])),
            ("machine", str(record["machine"])),
            *((name, str(version)) for name, version in record["versions"].items()),
            ("made on", str(record["date"])),
        ]
        for key, text in pairs:
            self.provenance.setdefault(key, {})[text] = None

    def _put(self, name: str, unit: str, cells: Cells, values: FloatArray) -> None:
        """Take the values of a metric of some cells, shape (n, repetitions)."""
        self.units[name] = unit
        self._measured[cells] = True
        known, width = self._values.get(name), values.shape[1]
        if known is None or known.shape[1] < width:
            wider = np.full((len(self.failures), width), np.nan)
            if known is not None:
                wider[:, : known.shape[1]] = known
            known = self._values[name] = wider
        known[cells, :width] = values

    def values(self) -> dict[str, FloatArray]:
        """Return each metric in each repetition, shape (cells, repetitions); see Measurements."""
        width = max((values.shape[1] for values in self._values.values()), default=1)
        # A run of which no repetition ended stores no metric at all.
        lost = ~self._measured & np.array([bool(text) for text in self.failures], dtype=bool)
        for name, values in self._values.items():
            missing = width - values.shape[1]
            whole = values if not missing else np.pad(values, ((0, 0), (0, missing)), constant_values=np.nan)
            whole[lost] = np.inf
            self._values[name] = whole
        return self._values


def commit_text(commit: object) -> str:
    """Return a commit as the provenance of a sweep tells it."""
    return str(commit or "none (installed package)")
