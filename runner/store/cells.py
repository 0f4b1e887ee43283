"""Baselines of sweeps: the metrics of each cell, and the run, the machine and the versions that gave them.

A file is `{schema: 2, machines: {KEY: PARTS}, versions: {KEY: {LIBRARY: VERSION}}, cells: {OVERRIDES: {run: NAME,
machine: KEY, versions: KEY, metrics: {NAME: {unit:, median:, min:, max:, seeds:, sensitive:}}}}}`. The form of schema
1, `{schema: 1, cells: {OVERRIDES: {NAME: {unit: ...}}}}`, is read, too. `runner check --save-baseline` writes a file.

A run has the name of its config, its robot and the code of the physics. If the name is equal, a metric can have moved
only because the machine or a library rounds differently.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import AfterValidator, Field, NonNegativeFloat

from runner.base.atomic import write_atomically
from runner.base.errors import StoreError
from runner.base.machine import ROUNDING, Machine, equal_up_to_rounding, parts_apart, read_machine
from runner.base.sanitize import escaped
from runner.schema.bound import Range
from runner.schema.model import StrictModel
from runner.store import Run, Sweep

SCHEMA = 2
FORMER = 1
"""Schema of files whose cells hold only metrics."""

SENSITIVE, ROUNDED, BROKEN = "sensitive to rounding", "rounding or a library", "not reproducible here"
"""Reasons why a metric moved although its run has the name that it had in the baseline."""


class Spread(StrictModel):
    """Values of one metric over the seeds.

    Attributes:
        unit: Unit of the metric.
        median: Median over the repetitions; null if half of them or more have no value.
        min: Smallest value; null if no repetition has one.
        max: Largest value; null if any repetition has none.
        seeds: Number of repetitions.
        sensitive: Share of the metric that rounding changes, if that was tried; above 1e-6 it is sensitive to rounding.
    """

    unit: str
    median: float | None
    min: float | None
    max: float | None
    seeds: int
    sensitive: NonNegativeFloat | None = None

    @property
    def range(self) -> Range:
        """The range of the seeds; a repetition without value counts as above every number."""
        return Range(*(math.inf if end is None else end for end in (self.min, self.max)))


class Cell(StrictModel):
    """Metrics of a cell, and what gave them.

    Attributes:
        run: Name of its run; null if it is unknown.
        machine: Key of the machine in `machines`; null if it is unknown.
        versions: Key of the versions in `versions`; null if they are unknown.
        metrics: Values of each metric.
    """

    run: str | None = None
    machine: str | None = None
    versions: str | None = None
    metrics: dict[str, Spread]


def _check_schema(number: object) -> object:
    if number not in (FORMER, SCHEMA):
        raise ValueError(f"must be {FORMER} or {SCHEMA}")
    return number


def _check_some(cells: dict[str, Any]) -> dict[str, Any]:
    if not any(cell.metrics if isinstance(cell, Cell) else cell for cell in cells.values()):
        raise ValueError("must have at least one metric")
    return cells


_Schema = Annotated[object, AfterValidator(_check_schema), Field(alias="schema")]


class SweepBaseline(StrictModel):
    """Baseline of a sweep.

    Attributes:
        schema_: Its schema.
        machines: Parts of each machine, by key.
        versions: Version of each library, by key.
        cells: The cells by their overrides.
    """

    schema_: _Schema
    machines: dict[str, dict[str, str]] = Field(default_factory=dict)
    versions: dict[str, dict[str, str]] = Field(default_factory=dict)
    cells: Annotated[dict[str, Cell], AfterValidator(_check_some)]

    @property
    def size(self) -> int:
        """Number of metrics of all cells."""
        return sum(len(cell.metrics) for cell in self.cells.values())


class FormerBaseline(StrictModel):
    """Baseline of a sweep in the form of schema 1.

    Attributes:
        schema_: Its schema.
        cells: Values of each metric, by the overrides of the cell.
    """

    schema_: _Schema
    cells: Annotated[dict[str, dict[str, Spread]], AfterValidator(_check_some)]

    def renewed(self) -> SweepBaseline:
        """Return the baseline in the present form; its runs, machines and versions are unknown."""
        cells = {name: Cell(metrics=own) for name, own in self.cells.items()}
        return SweepBaseline.model_validate({"schema": FORMER, "cells": cells})


@dataclass(frozen=True)
class Move:
    """A metric, or a whole cell, that changed since the baseline was saved.

    Attributes:
        cell: Overrides that distinguish the cell from others.
        metric: Name of the metric; empty for a whole cell.
        was: Values in the baseline; None if it has none.
        value: Its median now; None if there is none.
        beyond: Whether the change exceeds the spread of the seeds.
        event: What happened to the whole cell, such as its failure; empty for a metric.
        remark: SENSITIVE, ROUNDED or BROKEN if the run has the name that it had in the baseline; otherwise empty.
    """

    cell: str
    metric: str
    was: Spread | None
    value: float | None
    beyond: bool
    event: str = ""
    remark: str = ""

    @property
    def fails(self) -> bool:
        """Whether the change fails a check."""
        return self.remark == BROKEN or (self.beyond and self.remark != SENSITIVE)


@dataclass(frozen=True)
class SweepCheck:
    """Comparison of a sweep with a baseline.

    Attributes:
        moves: Everything that changed.
        notes: Sentences on cells of the baseline from another machine or other versions, or that name none.
    """

    moves: list[Move]
    notes: list[str]


def save_baseline(sweep: Sweep, path: Path, sensitive: Mapping[str, Mapping[str, float]]) -> int:
    """Write the baseline of a sweep; return its number of metrics.

    Args:
        sweep: The sweep.
        path: The file.
        sensitive: Share of each sensitive metric that rounding changes, by the hash of the run.

    Raises:
        StoreError: if a run of the sweep is missing or failed, or the file cannot be written.
    """
    machines: dict[str, dict[str, str]] = {}
    versions: dict[str, dict[str, str]] = {}
    cells: dict[str, dict[str, Any]] = {}
    for cell, name, run in zip(cell_names(sweep), sweep.hashes, sweep.runs(), strict=True):
        if run.failure is not None:
            raise StoreError(f"a failed run cannot be in a baseline: [{cell}] {run.failure}")
        changes = sensitive.get(name, {})
        cells[cell] = {
            "run": name,
            "machine": _key_of(read_machine(run.provenance["machine"]).record(), machines, "m"),
            "versions": _key_of(dict(run.provenance["versions"]), versions, "v"),
            "metrics": {
                metric: {
                    **{key: values[key] for key in ("unit", "median", "min", "max")},
                    "seeds": run.repetitions,
                    **({"sensitive": changes[metric]} if metric in changes else {}),
                }
                for metric, values in run.record["metrics"].items()
            },
        }
    content = {"schema": SCHEMA, "machines": machines, "versions": versions, "cells": cells}
    text = yaml.dump(content, sort_keys=False, width=120, Dumper=yaml.CSafeDumper)
    head = f"# Metrics of each cell over its seeds; written by `runner check DIR --save-baseline {path.name}` after\n"
    write_atomically(path, f"{head}# {escaped(sweep.command)}\n{text}".encode())
    return sum(len(cell["metrics"]) for cell in cells.values())


def _key_of(entry: dict[str, str], table: dict[str, dict[str, str]], letter: str) -> str:
    """Return the key of an entry in a table, and add the entry if it is new."""
    key = next((key for key, known in table.items() if known == entry), f"{letter}{len(table) + 1}")
    table[key] = entry
    return key


def check_sweep(sweep: Sweep, baseline: SweepBaseline) -> SweepCheck:
    """Return everything that changed between a baseline and a sweep, cell by cell.

    Raises:
        StoreError: if a run of the sweep is missing or damaged.
    """
    moves: list[Move] = []
    origins: Counter[str] = Counter()
    names = cell_names(sweep)
    for cell, name, run in zip(names, sweep.hashes, sweep.runs(), strict=True):
        known = baseline.cells.get(cell)
        if known is None:
            moves.append(Move(cell, "", None, None, False, "is new"))
        elif run.failure is not None:
            moves.append(Move(cell, "", None, None, True, run.failure))
        else:
            origin = _describe_origin(known, name, run, baseline)
            origins[origin] += 1
            moves += _compare(cell, run, known, "" if known.run != name else ROUNDED if origin else BROKEN)
    moves += [Move(cell, "", None, None, True, "is gone") for cell in baseline.cells if cell not in set(names)]
    notes = [f"{count} cell{'s' if count > 1 else ''}: {text}" for text, count in origins.items() if text]
    return SweepCheck(moves, notes)


def _describe_origin(known: Cell, name: str, run: Run, baseline: SweepBaseline) -> str:
    """Return a sentence on what made a cell of the baseline; empty if it equals what made the run, or is another run.

    Args:
        known: The cell in the baseline.
        name: Name of its run now.
        run: The run.
        baseline: The baseline.
    """
    if known.run is None:
        return "the baseline names no run, so rounding is not distinguished from other changes; save it again"
    if known.run != name:
        return ""
    machine, versions = read_machine(run.provenance["machine"]), run.provenance["versions"]
    their_machine = read_machine(baseline.machines.get(known.machine or ""))
    their_versions = baseline.versions.get(known.versions or "")
    if not their_machine.numpy or not machine.numpy or their_versions is None:
        return "the baseline or the run does not name machine and versions; a change may be rounding or a library"
    if (their_machine, their_versions) == (machine, versions):
        return ""
    others = [
        f"{library} {their_versions.get(library, 'none')} against {versions.get(library, 'none')} here"
        for library in dict.fromkeys([*their_versions, *versions])
        if their_versions.get(library) != versions.get(library)
    ]
    of_machine = [_against(machine, their_machine)] if their_machine != machine else []
    what = " and ".join([*["another machine"] * len(of_machine), *["other library versions"] * bool(others)])
    return f"the baseline is of {what}, which may round differently: {'; '.join([*of_machine, *others])}"


def _against(machine: Machine, theirs: Machine) -> str:
    names = parts_apart([theirs, machine])
    return f"{theirs.in_words(names) or theirs.text} against {machine.in_words(names) or machine.text} here"


def _compare(cell: str, run: Run, known: Cell, remark: str) -> Iterator[Move]:
    """Yield the metrics of a cell that changed; if they must have the same bits, which BROKEN means, any change."""
    for name in dict.fromkeys([*known.metrics, *run.metrics]):
        was, metric = known.metrics.get(name), run.metrics.get(name)
        value = None if metric is None else metric.median
        if was is None or metric is None:
            yield Move(cell, name, was, value, was is not None)
        elif was.median != value if remark == BROKEN else not equal_up_to_rounding(was.median, value):
            sensitive = remark == ROUNDED and (was.sensitive or 0.0) > ROUNDING
            beyond = was.range.verdict(value) != "within"
            yield Move(cell, name, was, value, beyond, remark=SENSITIVE if sensitive else remark)


def cell_names(sweep: Sweep) -> list[str]:
    """Return the overrides of each cell of a sweep that not all cells share."""
    shared = set(sweep.overrides[0]).intersection(*sweep.overrides)
    return [" ".join(text for text in job if text not in shared) or "all" for job in sweep.overrides]
