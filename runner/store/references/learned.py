"""Baseline of a whole sweep: each metric of each cell, with its spread over the seeds."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from runner.base.bounded_yaml import Bounds, YamlError, read_yaml
from runner.base.errors import StoreError
from runner.base.limits import Limit, read_text
from runner.base.sanitize import escaped
from runner.config.compose.messages import describe
from runner.schema.model import StrictModel
from runner.store import Run, Sweep
from runner.store.atomic import write_atomically

SCHEMA = 1
_BOUNDS = Bounds(Limit(200_000_000, "bytes"), values=5_000_000)  # some 10^5 cells
_ROUNDING = 1e-6  # of a value: what another machine's rounding may change


class Spread(StrictModel):
    """What the seeds gave for one metric.

    Attributes:
        unit: Its unit.
        median: Its median over the repetitions; null where half of them or more have none, as not settled.
        min: Smallest value; null where none has one.
        max: Largest value; null where any has none.
        seeds: Number of repetitions.
    """

    unit: str
    median: float | None
    min: float | None
    max: float | None
    seeds: int


Learned = Mapping[str, Mapping[str, Spread]]


@dataclass(frozen=True)
class Move:
    """A metric that is not what it was.

    Attributes:
        cell: Overrides that tell the cell from others.
        metric: Name of the metric; empty where the whole cell is meant.
        was: What the baseline holds; None where it holds none.
        value: Its median now; None where there is none.
        remark: What happened to the whole cell, as its failure; empty for a moved metric.
        beyond: Whether it is more than the seeds' spread.
    """

    cell: str
    metric: str
    was: Spread | None
    value: float | None
    remark: str
    beyond: bool


def learn(sweep: Sweep, path: Path) -> int:
    """Write the baseline of a sweep; return its number of metrics.

    Raises:
        StoreError: if a run of the sweep is missing or failed, or the file cannot be written.
    """
    cells: dict[str, dict[str, Any]] = {}
    for cell, run in zip(cell_names(sweep), sweep.runs(), strict=True):
        if run.failure is not None:
            raise StoreError(f"a failed run cannot be in a baseline: [{cell}] {run.failure_text}")
        cells[cell] = {name: _spread(run, metric).model_dump() for name, metric in run.metrics.items()}
    text = yaml.dump({"schema": SCHEMA, "cells": cells}, sort_keys=False, width=120, Dumper=yaml.CSafeDumper)
    head = f"# What each cell gave, over its seeds; made by `runner check DIR --save-baseline {path.name}` after\n"
    write_atomically(path, f"{head}# {escaped(sweep.command)}\n{text}".encode())
    return sum(map(len, cells.values()))


def load_learned(path: Path) -> Learned | None:
    """Read the baseline of a sweep, or return None if a file holds no cells: it is a baseline of another kind.

    Raises:
        StoreError: if it cannot be read or is damaged; lists all its problems.
    """
    try:
        content = read_yaml(read_text(path, _BOUNDS.size), path, _BOUNDS)
    except YamlError as error:
        raise StoreError(f"baseline {error}") from error
    except (OSError, ValueError) as error:
        raise StoreError(f"cannot read the baseline {path}: {error}") from error
    if not isinstance(content, dict) or "cells" not in content:
        return None
    problems: list[str] = []
    learned: dict[str, dict[str, Spread]] = {}
    if content.get("schema") != SCHEMA:
        problems.append(f"schema: must be {SCHEMA}; found {content.get('schema')!r}")
    cells = content["cells"] if isinstance(content["cells"], dict) else {}
    for cell, metrics in cells.items():
        learned[str(cell)] = {}
        for name, spread in (metrics if isinstance(metrics, dict) else {}).items():
            try:
                learned[str(cell)][str(name)] = Spread.model_validate(spread)
            except ValidationError as error:
                problems += describe(f"cells.{cell}.{name}", Spread, error)
    if not any(learned.values()):
        problems.append("cells: must hold the metrics of at least one cell")
    if problems:
        raise StoreError("\n".join([f"{path} is not a valid baseline:", *(f"  - {problem}" for problem in problems)]))
    return learned


def find_moves(sweep: Sweep, learned: Learned) -> list[Move]:
    """Return all that changed between a baseline and a sweep, cell by cell.

    Raises:
        StoreError: if a run of the sweep is missing or damaged.
    """
    moves: list[Move] = []
    found = set()
    for cell, run in zip(cell_names(sweep), sweep.runs(), strict=True):
        found.add(cell)
        if cell not in learned:
            moves.append(Move(cell, "", None, None, "is new", False))
        elif run.failure is not None:
            moves.append(Move(cell, "", None, None, run.failure_text, True))
        else:
            moves += _compare(cell, run, learned[cell])
    return moves + [Move(cell, "", None, None, "is gone", True) for cell in learned if cell not in found]


def cell_names(sweep: Sweep) -> list[str]:
    """Return what tells each cell of a sweep from others: the overrides that not all share."""
    shared = set(sweep.overrides[0]).intersection(*sweep.overrides)
    return [" ".join(text for text in job if text not in shared) or "all" for job in sweep.overrides]


def _compare(cell: str, run: Run, learned: Mapping[str, Spread]) -> Iterator[Move]:
    for name in dict.fromkeys([*learned, *run.metrics]):
        was, metric = learned.get(name), run.metrics.get(name)
        value = None if metric is None else metric["median"]
        if was is None or metric is None:
            yield Move(cell, name, was, value, "", was is not None)
        elif not _same(was.median, value):
            yield Move(cell, name, was, value, "", not _within(was, value))


def _same(a: float | None, b: float | None) -> bool:
    return a == b if a is None or b is None else math.isclose(a, b, rel_tol=_ROUNDING, abs_tol=1e-12)


def _within(was: Spread, value: float | None) -> bool:
    """Tell whether a median lies in the range of the seeds; no value counts as beyond every number."""
    low = math.inf if was.min is None else was.min
    high = math.inf if was.max is None else was.max
    return low <= (math.inf if value is None else value) <= high


def _spread(run: Run, metric: Mapping[str, Any]) -> Spread:
    ends = {key: metric[key] for key in ("unit", "median", "min", "max")}
    return Spread(seeds=int(run.record["repetitions"]), **ends)
