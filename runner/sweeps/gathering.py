"""Measurements of stored runs in arrays, read run by run or a shard at once."""

import contextlib
import io
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.machine import Machine, read_machine
from runner.store.parquet import numbers
from runner.store.run import Run
from runner.store.shards import METRIC, open_row, read_columns
from runner.sweeps.differing import Resolver

Cells = NDArray[np.intp]

_SEED = '"seed": '
_NEVER = "settling_time"  # end of the names of metrics whose missing value means that the arm never settled


class Gathered:
    """Measurements of the cells of a sweep.

    Args:
        cells: Number of cells.

    Attributes:
        hashes: Name of each cell's run.
        failures: Time, place and reason of the failure of each cell; empty for a successful one.
        seeds: Seed of each cell, shape (cells,).
        units: Unit of each metric.
        provenance: Plant, commit, machine, date and versions of the runs, each with its distinct values.
        machines: Distinct machines of the runs.
        caveats: Caveats of each cell.
        rules: Rules that were checked for caveats, each with the number of cells.
        configs: Each resolved config with its cells; the configs of a shard's cells may differ in the seed.
        rounding: Relative change of each metric through rounding, shape (cells,); 0 if it is unknown.
        undefined: True for repetitions of runs that do not define a metric, by metric, shape (cells, repetitions);
            known after `values`.
    """

    def __init__(self, cells: int) -> None:
        self.hashes = [""] * cells
        self.failures = [""] * cells
        self.seeds = np.zeros(cells, dtype=np.int64)
        self.units: dict[str, str] = {}
        self.provenance: dict[str, dict[str, None]] = {}
        self.machines: dict[Machine, None] = {}
        self.caveats: list[Sequence[Mapping[str, Any]]] = [()] * cells
        self.rules: list[tuple[Mapping[str, Any] | None, int]] = []
        self.configs: list[tuple[Mapping[str, Any], list[Cells]]] = []
        self.rounding: dict[str, FloatArray] = {}
        self.undefined: dict[str, NDArray[np.bool_]] = {}
        self._places: dict[object, int] = {}  # index of each config, by its JSON without the seed
        self._values: dict[str, FloatArray] = {}
        self._measured = np.zeros(cells, dtype=bool)
        self._resolver = Resolver()

    def add_run(self, cell: int, run: Run) -> None:
        """Add the run of a cell."""
        self.hashes[cell], self.failures[cell], self.caveats[cell] = run.hash, run.failure or "", run.caveats
        self.seeds[cell] = int(run.provenance["seed"])
        self._count_rules(run.caveat_rules, 1)
        self._note(run)
        for name, change in ({} if run.rounding is None else run.rounding["metrics"]).items():
            self.rounding.setdefault(name, np.zeros(len(self.hashes)))[cell] = change
        for name, metric in run.metrics.items():
            own = run.values(name)
            row = np.where(np.isnan(own), np.inf, own)
            self._put(name, metric.unit, np.array([cell]), row[None])
        self.configs.append((self._resolver.resolve(run), [np.array([cell])]))

    def add_shard(self, path: Path, rows: Cells, cells: Cells) -> None:
        """Add runs of a shard: in columns, or one by one if they have little in common.

        Args:
            path: The shard.
            rows: Rows of the shard to add, shape (n,).
            cells: Cell of each row, shape (n,).

        Raises:
            DamagedError: if the shard is damaged.
        """
        import pyarrow

        table = read_columns(path, ("run", "failure", "config", "record"), METRIC).take(rows)
        rules = None
        with contextlib.suppress(pyarrow.ArrowException, KeyError):  # two types of values under one key
            record = _parsed(table["record"].to_pylist())
            provenance = record.field("provenance")
            seeds, caveats = provenance.field("seed").to_numpy(), _caveats(record)
            metrics, made_by, machines = list(_metrics(table)), list(_made_by(provenance)), _machines(provenance)
            columnar = seeds.dtype.kind == "i" and record.type.get_field_index("rounding") < 0
            rules = _rules(record) if columnar else None
        if rules is None:
            for row, cell in zip(rows.tolist(), cells.tolist(), strict=True):
                self.add_run(cell, open_row(path, row))
            return
        self.seeds[cells] = seeds
        names, failures = table["run"].to_pylist(), table["failure"].to_pylist()
        for place, cell in enumerate(cells.tolist()):
            self.hashes[cell], self.failures[cell], self.caveats[cell] = names[place], failures[place], caveats[place]
        for some, count in rules:
            self._count_rules(some, count)
        for key, same in _settings(table["config"].to_pylist()).items():
            if key not in self._places:
                run = open_row(path, int(rows[same[0]]))
                self._note(run)
                self._places[key] = len(self.configs)
                self.configs.append((self._resolver.resolve(run), []))
            self.configs[self._places[key]][1].append(cells[same])
        self.machines |= machines
        for name, texts in [*made_by, ("machine", [machine.text for machine in machines])]:
            self.provenance.setdefault(name, {}).update(dict.fromkeys(texts))
        for name, unit, members, values in metrics:
            self._put(name, unit, cells[members], values)

    def _count_rules(self, rules: Mapping[str, Any] | None, count: int) -> None:
        for place, (known, before) in enumerate(self.rules):
            if known == rules:
                self.rules[place] = (known, before + count)
                return
        self.rules.append((rules, count))

    def _note(self, run: Run) -> None:
        """Add the provenance of a run."""
        record, machine = run.provenance, read_machine(run.provenance["machine"])
        self.machines[machine] = None
        pairs = [
            ("plant", f"{run.config['plant']['kind']}, step {record['plant_step']:g} s"),
            ("commit", commit_text(record["commit"])),
            ("seed", str(record["seed"])),
            ("machine", machine.text),
            *((name, str(version)) for name, version in record["versions"].items()),
            ("made on", str(record["date"])),
        ]
        for key, text in pairs:
            self.provenance.setdefault(key, {})[text] = None

    def _put(self, name: str, unit: str, cells: Cells, values: FloatArray) -> None:
        """Store the values of a metric of some cells, shape (n, repetitions)."""
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
        """Return the values of each metric, shape (cells, repetitions); see Measurements."""
        width = max((values.shape[1] for values in self._values.values()), default=1)
        # A run without a finished repetition stores no metric.
        failed = np.array([bool(text) for text in self.failures], dtype=bool)
        lost = ~self._measured & failed
        for name, values in self._values.items():
            missing = width - values.shape[1]
            whole = values if not missing else np.pad(values, ((0, 0), (0, missing)), constant_values=np.nan)
            whole[lost] = np.inf
            if not name.endswith(_NEVER):
                undefined = np.isinf(whole) & ~(failed | np.isfinite(whole).any(axis=1))[:, None]
                if undefined.any():
                    self.undefined[name] = undefined
                    whole[undefined] = np.nan
            self._values[name] = whole
        return self._values


def commit_text(commit: object) -> str:
    """Return a commit as a string for the provenance of a sweep."""
    return str(commit or "none (installed package)")


def _parsed(records: Sequence[str]) -> Any:
    """Return JSON records as one struct array; pyarrow parses all of them at once."""
    import pyarrow
    import pyarrow.json

    content = "\n".join(records).encode()
    text, number = pyarrow.string(), pyarrow.float64()
    caveat = pyarrow.struct({"rule": text, "text": text, "value": number})
    known = pyarrow.schema({
        "caveats": pyarrow.list_(caveat),
        "provenance": pyarrow.struct({"date": text, "commit": text, "command": text}),
    })  # fmt: skip
    table = pyarrow.json.read_json(
        io.BytesIO(content),
        read_options=pyarrow.json.ReadOptions(use_threads=False, block_size=len(content) + 1),
        parse_options=pyarrow.json.ParseOptions(explicit_schema=known),
    )
    return table.to_struct_array().combine_chunks()


def _settings(configs: Sequence[str]) -> dict[object, list[int]]:
    """Group configs, given as JSON, that differ only in the seed; return the indices by the JSON without the seed."""
    found: dict[object, list[int]] = {}
    for place, text in enumerate(configs):
        before, _, after = text.partition(_SEED)
        key = (text,) if _SEED in after else (before, after.partition(",")[2])
        found.setdefault(key, []).append(place)
    return found


def _rules(record: Any) -> list[tuple[Mapping[str, Any] | None, int]] | None:
    """Return the rules that were checked for caveats, with the number of runs; None if runs have different rules."""
    if record.type.get_field_index("caveat_rules") < 0:
        return [(None, len(record))]
    rules = _inner(record, "caveat_rules").drop_null()
    if any(len(leaf.unique()) > 1 for leaf in _leaves(rules)):
        return None
    found: list[tuple[Mapping[str, Any] | None, int]] = [(rules[0].as_py(), len(rules))] if len(rules) else []
    return [*found, (None, len(record) - len(rules))] if len(rules) < len(record) else found


def _leaves(array: Any) -> Iterator[Any]:
    import pyarrow

    if isinstance(array, pyarrow.StructArray):
        for inner in array.flatten():
            yield from _leaves(inner)
    else:
        yield array


def _caveats(record: Any) -> list[Sequence[Mapping[str, Any]]]:
    """Return the caveats of each run; runs with equal caveats share one object."""
    found = _inner(record, "caveats")
    counts = np.nan_to_num(found.value_lengths().to_numpy(zero_copy_only=False)).astype(int).tolist()
    columns = [column.to_pylist() for column in found.flatten().flatten()]
    names = [field.name for field in found.type.value_type]
    every = iter(zip(*columns, strict=True))
    shared: dict[object, Sequence[Mapping[str, Any]]] = {}
    lists: list[Sequence[Mapping[str, Any]]] = []
    for count in counts:
        own = tuple(next(every) for _ in range(count))
        if own not in shared:
            shared[own] = tuple(dict(zip(names, values, strict=True)) for values in own)
        lists.append(shared[own])
    return lists


def _made_by(provenance: Any) -> Iterator[tuple[str, Sequence[str]]]:
    """Yield the distinct values of each provenance entry."""
    yield "commit", [commit_text(value) for value in provenance.field("commit").unique().to_pylist()]
    versions = provenance.field("versions")
    for field in versions.type:
        yield field.name, [value for value in versions.field(field.name).unique().to_pylist() if value is not None]
    yield "made on", provenance.field("date").unique().to_pylist()


def _machines(provenance: Any) -> dict[Machine, None]:
    """Return the distinct machines of a shard's runs."""
    import pyarrow

    stored = provenance.field("machine")
    if not isinstance(stored, pyarrow.StructArray):
        return dict.fromkeys(map(read_machine, stored.unique().to_pylist()))
    names = [part.name for part in stored.type]
    rows = set(zip(*(part.to_pylist() for part in stored.flatten()), strict=True))
    return dict.fromkeys(read_machine(dict(zip(names, row, strict=True))) for row in rows)


def _metrics(table: Any) -> Iterator[tuple[str, str, Cells, FloatArray]]:
    """Yield name and unit of each metric, the runs that have it, and their values, shape (runs, repetitions).

    The values are NaN after the last repetition of a run, and infinite if a repetition has no value.
    """
    for field in table.schema:
        if field.name.startswith(METRIC):
            values = table[field.name].combine_chunks()
            counts = values.value_lengths().to_numpy(zero_copy_only=False)
            members = np.flatnonzero(~np.isnan(counts.astype(float)))
            sizes = counts[members].astype(int)
            flat = numbers(values.flatten())
            rows = np.full((len(members), int(sizes.max(initial=0))), np.nan)
            rows[np.arange(rows.shape[1]) < sizes[:, None]] = np.where(np.isnan(flat), np.inf, flat)
            yield field.name.removeprefix(METRIC), (field.metadata or {}).get(b"unit", b"").decode(), members, rows


def _inner(array: Any, name: str) -> Any:
    """Return a field of a struct array; it is missing if the struct is missing."""
    return array.flatten()[array.type.get_field_index(name)]
