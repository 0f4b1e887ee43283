"""Plan of a sweep: its cells with their configs in blocks, composed and checked before the first run."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, Protocol

import numpy as np
from numpy.typing import NDArray

from runner import store
from runner.base import progress
from runner.base.errors import ConfigError
from runner.config.calibration import validate_calibration
from runner.config.compose.compose import Composed
from runner.config.limits import LimitsConfig, memory_of_run
from runner.config.run import RunConfig
from runner.config.spec import Bound
from runner.config.sweep import SweepConfig
from runner.config.validation import validate
from runner.simulation.assembly import assemble
from runner.store.axes import GridOverrides
from runner.store.identity import json_text
from runner.store.names import Names, Texts
from runner.sweeps.calibration_job import CALIBRATION, TICKS
from runner.sweeps.differing import Resolved, is_one_arm, resolve


@dataclass(frozen=True)
class Block:
    """Cells whose configs differ in nothing but the seed.

    Attributes:
        cells: The cells.
        seeds: Seed of each; None of a single cell.
    """

    cells: range
    seeds: Sequence[int] | None = None


@dataclass(frozen=True)
class Alike(Sequence[Composed]):
    """Configs that differ in nothing but the seed, made when asked for: to another process goes one of them.

    Attributes:
        first: One of them.
        seeds: Seed of each.
        texts: The override that gives each its seed.
        place: Place of that among the overrides.
    """

    first: Composed
    seeds: Sequence[int]
    texts: Sequence[str]
    place: int

    def __len__(self) -> int:
        return len(self.seeds)

    def __getitem__(self, number: Any) -> Any:
        first, place = self.first, self.place
        overrides = (*first.overrides[:place], self.texts[number], *first.overrides[place + 1 :])
        resolved = {**first.resolved, "seed": self.seeds[number]}
        return Composed(resolved, overrides, first.choices, first.config_dirs, first.root)


@dataclass(frozen=True)
class Part:
    """Runs whose configs differ in nothing but the seed, or a single run or calibration.

    Attributes:
        names: Hash of each.
        configs: Composed config of each.
    """

    names: Sequence[str]
    configs: Sequence[Composed]


_PROBLEMS_SHOWN = 20


class Plan(Protocol):
    """Runs and calibrations to make, counted as cells."""

    def __len__(self) -> int:
        """Return the number of cells."""
        ...

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell, as typed; what only says how and where it is made is left out."""
        ...

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell, of which cells that share a group share the object.

        Raises:
            ConfigError: if it does not compose.
        """
        ...

    def axes(self) -> GridOverrides | None:
        """Return the axes of a grid, whose cells have every combination of their overrides; None of no grid."""
        ...

    def blocks(self) -> Iterator[Block]:
        """Yield all cells, in blocks that differ in nothing but the seed."""
        ...

    def alike(self, cells: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Composed]]]:
        """Yield those of some cells whose configs differ in nothing but the seed, with their configs."""
        ...


@dataclass(frozen=True)
class Checked:
    """What the check of a plan gave.

    Attributes:
        names: Hash of each cell's run or calibration.
        costs: Ticks of all its repetitions together, shape (cells,).
        calibrations: The cells that are calibrations, not runs.
        outputs: Folder in which they are stored.
        settings: How the runs are made.
        limits: What they may cost.
        spec: Bounds on metrics.
        resolved: What differs between the configs of the runs.
        memory: What the largest of its runs takes, in bytes.
    """

    names: Names
    costs: NDArray[np.int64]
    calibrations: frozenset[int]
    outputs: Path
    settings: SweepConfig
    limits: LimitsConfig
    spec: Mapping[str, Bound]
    resolved: Resolved
    memory: float


def check(plan: Plan) -> Checked:
    """Compose and check all cells of a plan, one of which is a run.

    Raises:
        ConfigError: telling each problem once, with the first cell that has it.
    """
    names, costs = np.empty(len(plan), dtype="S24"), np.empty(len(plan), dtype=np.int64)
    calibrations: set[int] = set()
    problems = _Problems()
    first: RunConfig | None = None
    memory = 0.0
    resolved = Resolved()
    assembled: dict[tuple[str, bytes], ConfigError | None] = {}
    progress.begin("checking", len(plan), "cells")
    for block in plan.blocks():
        cells = slice(block.cells.start, block.cells.stop, block.cells.step)
        try:
            composed = plan.composed(block.cells[0])
            if composed.root == CALIBRATION:
                calibrations.add(block.cells[0])
                names[cells], costs[cells] = _check_calibration(composed)
                continue
            config = validate(composed.resolved, composed.config_dirs)
            first = first or config
            _check_alike(first, config)
            _check_assembly(composed, config, assembled)
            names[cells] = _names(composed, config, block)
            repetitions = config.settings.repetitions
            costs[cells] = config.timing.ticks * repetitions
            memory = max(memory, memory_of_run(config.arm, config.timing.ticks, repetitions, config.has_contact))
            start = config.path.start.tolist() if is_one_arm(composed.resolved) else None
            described = resolve(composed.resolved, config.timing.step, start)
            resolved.add(described, composed.overrides, block.cells)
        except ConfigError as error:
            problems.add(error, block)
        finally:
            progress.step(len(block.cells))
    if problems or first is None:
        problems.report(plan)
    outputs = Path(first.settings.outputs)
    shared = first.sweep, first.limits, first.spec.metrics
    return Checked(Names(names), costs, frozenset(calibrations), outputs, *shared, resolved, memory)


class _Problems:
    """What is wrong: each problem with its first cell and the number of cells that have it."""

    def __init__(self) -> None:
        self._found: dict[str, tuple[int, int]] = {}

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, error: ConfigError, block: Block) -> None:
        """Take the problems of the cells of a block."""
        for problem in error.problems:
            first, count = self._found.get(problem, (block.cells[0], 0))
            self._found[problem] = min(first, block.cells[0]), count + len(block.cells)

    def report(self, plan: Plan) -> NoReturn:
        """End the check, with the problems in the order of the cells.

        Raises:
            ConfigError: always.
        """
        found = sorted(self._found.items(), key=lambda item: item[1][0])
        more = len(found) - _PROBLEMS_SHOWN
        hint = "  nothing was started" if more <= 0 else f"  and {more} more problems; nothing was started"
        raise ConfigError([_describe(plan, problem, *where) for problem, where in found[:_PROBLEMS_SHOWN]], hint)


def _names(composed: Composed, config: RunConfig, block: Block) -> Texts:
    """Return the names of the runs of a block, shape (n,)."""
    if block.seeds is None:
        return Names.of([store.run_hash(composed.resolved, config.arm.urdf)]).texts
    return store.run_hashes(composed.resolved, config.arm.urdf, block.seeds).texts


def _check_calibration(composed: Composed) -> tuple[str, int]:
    """Return hash and cost of a calibration."""
    config = validate_calibration(composed)
    name = store.run_hash(config.resolved, config.arm.urdf)
    return name, TICKS * config.settings.repetitions


def _check_alike(first: RunConfig, other: RunConfig) -> None:
    if _shared(first) != _shared(other):
        raise ConfigError(["outputs, sweep.*, limits.*, caveats.*, spec.*: must have one value in all runs of a sweep"])


def _shared(config: RunConfig) -> tuple[object, ...]:
    """Return what is the same in all runs of a sweep."""
    return config.settings.outputs, config.sweep, config.limits, config.caveats, config.spec


def _check_assembly(
    composed: Composed, config: RunConfig, assembled: dict[tuple[str, bytes], ConfigError | None]
) -> None:
    """Assemble each robot on each plant from each start once: some problems show only there."""
    parts = [json_text(composed.resolved[group]) for group in ("robot", "plant")]
    key = ", ".join(parts), config.path.start.tobytes()
    if key not in assembled:
        assembled[key] = None
        try:
            assemble(config).close()
        except ConfigError as error:
            assembled[key] = error
    problem = assembled[key]
    if problem is not None:
        raise problem


def _describe(plan: Plan, problem: str, cell: int, count: int) -> str:
    others = f" and {count - 1} other cell{'s' if count > 2 else ''}:" if count > 1 else ""
    return f"[{' '.join(plan.overrides(cell))}]{others} {problem}"
