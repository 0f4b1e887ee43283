"""Measurements of a sweep by cell: swept axes, status, and every metric in every repetition."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base import progress
from runner.base.arrays import FloatArray
from runner.base.dotted_keys import get, split_override
from runner.base.errors import RunnerError, StoreError, unknown
from runner.base.machine import Machine
from runner.store.axes import Axis, axes_of, find_cells, make_axis
from runner.store.drawn import draws_nothing
from runner.store.finished import Finished, finer_names, read_finer
from runner.store.run import Run
from runner.store.sweep import InShard, Sweep
from runner.sweeps.differing import Resolved, UnsweptDifference
from runner.sweeps.gathering import Gathered
from runner.sweeps.status import report_if_running


@dataclass(frozen=True)
class Measurements:
    """Results of the cells of a sweep, in the order of its jobs; a run counts as a sweep of one cell.

    Attributes:
        axes: The swept axes.
        fixed: Overrides that all cells share, as typed.
        hashes: Name of each cell's run.
        statuses: "ok" or "failed".
        failures: Time, place and reason of the failure of each cell; empty for a successful one.
        units: Unit of each metric.
        values: Values of each metric, shape (cells, repetitions): infinite, that is beyond every number, if the
            repetition failed or never settled; NaN if the run has no such metric or repetition, or does not define it,
            as a run that ends too early has no steady state.
        provenance: Plant, commit, machine, date and so on of the runs, each with its distinct values.
        caveats: Caveats of each cell as stored: rule, text, value, repetitions.
        caveat_rules: Digest and thresholds of the rules behind these caveats, each with the number of cells.
        seeds: Seed of each cell; empty if all cells have the same seed.
        differences: Resolved config values that differ between cells beyond the axes.
        configs: Each resolved config with its cells; the configs of these cells may differ in the seed.
        finer: Values of each metric in the first repetitions on a finer step of the plant, as `values`; NaN if
            unknown.
        rounding: Relative change of each metric through rounding, shape (cells,); 0 if it is unknown.
        undefined: True for repetitions of runs that do not define a metric, by metric, shape (cells, repetitions).
        name: Name in a comparison, such as "A".
        folder: Folder of the sweep or run.
        command: The command that makes the sweep or run.
        missing: Number of cells that are not stored.
        unseen: Values of swept keys without any stored cell, such as "robot=macro".
        damage: Damaged files, a message for each.
        machines: Distinct machines that made the runs.
        question: Axis that a user asked about; empty for none.
    """

    axes: Sequence[Axis]
    fixed: Sequence[str]
    hashes: Sequence[str]
    statuses: Sequence[str]
    failures: Sequence[str]
    units: Mapping[str, str]
    values: Mapping[str, FloatArray]
    provenance: Mapping[str, Sequence[str]]
    caveats: Sequence[Sequence[Mapping[str, Any]]] = ()
    caveat_rules: Sequence[tuple[Mapping[str, Any] | None, int]] = ()
    seeds: Sequence[int] | NDArray[np.int64] = ()
    differences: Sequence[UnsweptDifference] = ()
    configs: Sequence[tuple[Mapping[str, Any], NDArray[np.intp]]] = ()
    finer: Mapping[str, FloatArray] = field(default_factory=dict)
    rounding: Mapping[str, FloatArray] = field(default_factory=dict)
    undefined: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)
    name: str = ""
    folder: Path = Path()
    command: str = ""
    missing: int = 0
    unseen: Sequence[str] = ()
    damage: Sequence[str] = ()
    machines: Sequence[Machine] = ()
    question: str = ""

    @property
    def failed(self) -> int:
        """Number of cells that failed."""
        return sum(status != "ok" for status in self.statuses)

    @cached_property
    def caveat_changes(self) -> Mapping[str, int]:
        """Differences between the stored caveat rules and the current ones, each with the number of cells."""
        from runner.caveats.versions import changes_since  # imports all rules

        found: Counter[str] = Counter()
        for rules, count in self.caveat_rules:
            found.update(dict.fromkeys(changes_since(rules), count))
        return found

    @cached_property
    def config_of_cells(self) -> NDArray[np.intp]:
        """Index of each cell's config in `configs`, shape (cells,)."""
        places = np.zeros(len(self.hashes), dtype=np.intp)
        for place, (_, cells) in enumerate(self.configs):
            places[cells] = place
        return places

    def caveats_by_rule(self) -> list[tuple[str, int, int, str]]:
        """Return each rule with its number of cells, and the cell and the message of its largest value.

        The rule with the most cells comes first.
        """
        found: dict[str, list[tuple[int, Mapping[str, Any]]]] = {}
        for cell, caveats in enumerate(self.caveats):
            for caveat in caveats:
                found.setdefault(str(caveat["rule"]), []).append((cell, caveat))
        rows = []
        for rule, some in sorted(found.items(), key=lambda item: -len(item[1])):
            cell, worst = max(some, key=lambda entry: float(entry[1]["value"]))
            rows.append((rule, len(some), cell, str(worst["text"])))
        return rows

    def resolved(self, key: str) -> list[Any]:
        """Return the resolved value of a dotted key in each config: a mapping for a group, None if it is missing."""
        return [get(config, key) for config, _ in self.configs]

    @cached_property
    def copies(self) -> NDArray[np.bool_]:
        """True for cells in which nothing is drawn: their repetitions are equal in every metric, shape (cells,)."""
        alike = np.full(len(self.hashes), self.repetitions > 1)
        for values in self.values.values():
            alike &= ((values == values[:, :1]) | np.isnan(values)).all(axis=1)
        for config, cells in self.configs if self.repetitions == 1 else ():
            alike[cells] = draws_nothing(config)
        return alike

    @cached_property
    def draws(self) -> NDArray[np.intp]:
        """Number of the random draws behind each value, shape (cells, repetitions).

        Cells with the same seed have equal numbers in the same repetition. All other numbers differ.
        """
        seeds = np.unique(self.seeds, return_inverse=True)[1] if len(self.seeds) else np.zeros(len(self.hashes), int)
        return seeds[:, None] * self.repetitions + np.arange(self.repetitions)

    @property
    def repetitions(self) -> int:
        """Largest number of repetitions of a cell; if all failed, that of their configs."""
        asked = [int(config["repetitions"]) for config, _ in self.configs] if not self.values else []
        return max((values.shape[1] for values in self.values.values()), default=max(asked, default=1))

    def named(self, wanted: Sequence[str] | None) -> Sequence[str]:
        """Return the names of the wanted metrics, each once; all metrics for None.

        Raises:
            RunnerError: If the sweep lacks one; the message has the nearest name and all names.
        """
        check_metrics(wanted or (), self.values)
        return list(self.values if wanted is None else dict.fromkeys(wanted))

    def of_cell(self, metric: str, cell: int) -> FloatArray:
        """Return the values of a metric over the repetitions of one cell, shape (n,)."""
        row = self.values[metric][cell]
        values: FloatArray = row[~np.isnan(row)]
        return values

    def medians(self, metric: str) -> FloatArray:
        """Return the median of a metric in each cell, shape (cells,); it may be infinite or NaN, as the values."""
        return medians(np.sort(self.values[metric], axis=1))  # NaN comes last because it is not a repetition

    def axis_columns(self, cells: slice | NDArray[np.intp] = slice(None)) -> dict[str, object]:
        """Return the values of some cells on each axis, by the names of the axes."""
        return {axis.name: [axis.values[level] for level in axis.level[cells].tolist()] for axis in self.axes}


def medians(ordered: FloatArray) -> FloatArray:
    """Return the median of each row, shape (cells,).

    Args:
        ordered: Values, shape (cells, repetitions), ascending, NaN last.
    """
    if ordered.shape[1] == 1:
        return ordered[:, 0].copy()
    count = np.sum(~np.isnan(ordered), axis=1)
    cells = np.arange(len(ordered))
    low, high = ordered[cells, np.maximum(count - 1, 0) // 2], ordered[cells, count // 2]
    found: FloatArray = (low + high) / 2
    return found


def measure(overrides: Sequence[Sequence[str]], runs: Iterable[Run]) -> Measurements:
    """Return the measurements of runs, added one by one.

    Args:
        overrides: Overrides of each job, as typed.
        runs: The run of each job.

    Raises:
        StoreError: If a run is missing or damaged.
    """
    gathered = Gathered(len(overrides))
    for cell, (run, _) in enumerate(zip(runs, overrides, strict=True)):
        gathered.add_run(cell, run)
    return _measured(overrides, gathered)


def measure_run(run: Run, name: str = "") -> Measurements:
    """Return a run as a sweep of one cell."""
    measured = _with_finer(measure([()], [run]), run.folder.parent.parent)
    return replace(measured, name=name, folder=run.folder, command=str(run.provenance["command"]))


def measure_sweep(sweep: Sweep) -> Measurements:
    """Read the runs of a sweep; the runs of a shard are read together.

    Raises:
        StoreError: If a run is missing or damaged.
    """
    measured = _with_finer(_measured(sweep.overrides, _gather(sweep)), sweep.outputs)
    return replace(measured, folder=sweep.folder, command=sweep.command, question=sweep.question)


def _gather(sweep: Sweep) -> Gathered:
    gathered = Gathered(len(sweep.hashes))
    progress.begin("reading runs", len(sweep.hashes), "cells")
    with report_if_running(sweep):
        for found in sweep.found():
            if isinstance(found, InShard):
                gathered.add_shard(found.path, found.rows, found.cells)
                progress.step(len(found.cells))
            else:
                gathered.add_run(*found)
                progress.step()
    return gathered


def measure_stored(sweep: Sweep, name: str = "") -> Measurements:
    """Read the stored cells of a sweep, which may still be running.

    Raises:
        StoreError: If no cell is stored.
        DamagedError: If a stored run is damaged.
    """
    part, damage = stored_part(sweep)
    if not len(part.hashes):
        raise StoreError(
            f"{sweep.folder}: none of its {len(sweep.hashes)} cells is stored; continue with: {sweep.continuation}"
        )
    missing = len(sweep.hashes) - len(part.hashes)
    measured = measure_sweep(part)
    unseen = _unseen(sweep, part) if missing else ()
    return replace(measured, name=name, folder=sweep.folder, missing=missing, unseen=unseen, damage=damage)


def _unseen(sweep: Sweep, part: Sweep) -> list[str]:
    """Return the values of the swept keys of a sweep, as overrides, that no cell of a part of it has."""
    seen = {text for job in part.overrides for text in job}
    names = {axis.name for axis in axes_of(sweep.overrides)[0]}
    every = dict.fromkeys(text for job in sweep.overrides for text in job if text.partition("=")[0] in names)
    return [text for text in every if text not in seen]


def stored_part(sweep: Sweep) -> tuple[Sweep, Sequence[str]]:
    """Return a sweep reduced to its stored cells, and messages on damaged files."""
    finished = Finished(sweep.outputs)
    stored = {name: finished.outcome(name) is not None for name in set(sweep.hashes)}
    if all(stored.values()):
        return sweep, finished.damage
    return _part(sweep, [cell for cell, name in enumerate(sweep.hashes) if stored[name]]), finished.damage


def limit_sweep(sweep: Sweep, where: Sequence[str]) -> Sweep:
    """Return a sweep reduced to the cells that have some values, swept or in their configs; see `find_cells`."""
    if not where:
        return sweep
    axes, fixed = axes_of(sweep.overrides)
    _, others = split_where(sweep, where)
    if others:
        keys = {text.partition("=")[0] for text in others}
        axes = [*axes, *_config_axes(_gather(sweep), keys, dict(map(split_override, fixed)))]
    return _part(sweep, find_cells(axes, where, len(sweep.hashes)).tolist())


def split_where(sweep: Sweep, where: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the values, each as KEY=VALUE, of swept keys and of other keys."""
    names = {axis.name for axis in axes_of(sweep.overrides)[0]}
    swept = [text for text in where if text.partition("=")[0] in names]
    return swept, [text for text in where if text not in swept]


def _config_axes(gathered: Gathered, keys: Collection[str], typed: Mapping[str, str]) -> Iterator[Axis]:
    """Yield an axis for each key that is in the config of every cell; the value of a group is its option.

    Args:
        gathered: The cells.
        keys: The keys.
        typed: Values of the keys that all cells share, as typed.

    Raises:
        RunnerError: If a key is a group whose option is not stored.
    """
    for key in keys:
        values: list[Any] = [None] * len(gathered.hashes)
        for config, members in gathered.configs:
            value = get(config, key)
            if isinstance(value, Mapping):
                value = _option(key, value, typed)
            for cell in np.concatenate(members).tolist():
                values[cell] = value
        if None not in values:
            yield make_axis(key, values)


def _option(key: str, group: Mapping[str, Any], typed: Mapping[str, str]) -> Any:
    """Return the option of a group: as typed, else its kind, else its name."""
    given = typed.get(key, "")
    option = given if given and "{" not in given else group.get("kind", group.get("name"))
    if option is None:
        keys = ", ".join(f"{key}.{name}" for name in group)
        raise RunnerError(f"--where {key}: a group whose option is not stored. Allowed: {keys}.")
    return option


def _part(sweep: Sweep, cells: Sequence[int]) -> Sweep:
    hashes = [sweep.hashes[cell] for cell in cells]
    return replace(sweep, overrides=[sweep.overrides[cell] for cell in cells], hashes=hashes)


def _with_finer(measurements: Measurements, outputs: Path) -> Measurements:
    """Return measurements with the metrics on a finer step of the plant, for the cells that have them stored."""
    known = finer_names(outputs)
    rows = [(cell, read_finer(outputs, name)) for cell, name in enumerate(measurements.hashes) if name in known]
    if not rows:
        return measurements
    width = max((len(row) for _, metrics in rows for row in metrics.values()), default=0)
    finer = {name: np.full((len(measurements.hashes), width), np.nan) for name in measurements.values}
    for cell, metrics in rows:
        for name in finer.keys() & metrics.keys():
            finer[name][cell, : len(metrics[name])] = metrics[name]
    return replace(measurements, finer=finer)


def _measured(overrides: Sequence[Sequence[str]], gathered: Gathered) -> Measurements:
    axes, fixed = axes_of(overrides)
    keys = [axis.name for axis in axes] + [split_override(text)[0] for text in fixed]
    resolved = Resolved()
    for config, members in gathered.configs:
        cells = np.concatenate(members)
        for some in [cells] if "seed" in keys else _by_seed(cells, gathered.seeds):
            resolved.add({**config, "seed": int(gathered.seeds[some[0]])}, overrides[int(cells[0])], some)
    provenance = gathered.provenance
    if "seed" in provenance:
        provenance["seed"] = dict.fromkeys(map(str, np.unique(gathered.seeds).tolist()))
    return Measurements(
        axes,
        fixed,
        gathered.hashes,
        ["failed" if failure else "ok" for failure in gathered.failures],
        gathered.failures,
        gathered.units,
        gathered.values(),
        {key: sorted(texts) for key, texts in provenance.items()},
        gathered.caveats,
        gathered.rules,
        gathered.seeds,
        resolved.differences(axes),
        [(config, np.concatenate(members)) for config, members in gathered.configs],
        machines=list(gathered.machines),
        rounding=gathered.rounding,
        undefined=gathered.undefined,
    )


def _by_seed(cells: NDArray[np.intp], seeds: NDArray[np.int64]) -> list[NDArray[np.intp]]:
    return [cells[seeds[cells] == seed] for seed in np.unique(seeds[cells])]


def check_metrics(wanted: Sequence[str], known: Iterable[str]) -> None:
    """Check that metrics exist.

    Args:
        wanted: Names of the wanted metrics.
        known: Names of the existing metrics.

    Raises:
        RunnerError: For the first unknown metric.
    """
    names = list(dict.fromkeys(known))
    for name in wanted:
        if name not in names:
            raise RunnerError(unknown("metric", name, names or ["none, because all runs failed"], "metrics"))
