"""Check of a plan: composes and checks all cells before the first run."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from runner import store
from runner.assembly.assemble import check_assembly
from runner.assembly.run_config import RunConfig
from runner.assembly.run_cost import memory_of_run
from runner.base import progress
from runner.base.errors import ConfigError
from runner.store.identity import json_text
from runner.store.names import Names
from runner.sweeps.differing import Resolved, is_one_arm, resolve
from runner.sweeps.job import CalibrationJob, check_job
from runner.sweeps.plan import Plan

_PROBLEMS_SHOWN = 20


@dataclass(frozen=True)
class Checked:
    """Result of the check of a plan.

    Attributes:
        names: Hash of each cell's run or calibration.
        costs: Number of ticks of each cell, summed over its repetitions, shape (cells,).
        calibrations: Numbers of the cells that are calibrations, not runs.
        outputs: Outputs folder of the runs and calibrations.
        first: Config of the first run. All runs have its settings of the sweep, limits and bounds on metrics.
        resolved: Values that differ between the configs of the runs.
        memory: Memory of the largest run, in bytes.
    """

    names: Names
    costs: NDArray[np.int64]
    calibrations: frozenset[int]
    outputs: Path
    first: RunConfig
    resolved: Resolved
    memory: float


def check(plan: Plan) -> Checked:
    """Compose and check all cells of a plan, which contains at least one run.

    Raises:
        ConfigError: if a cell has a problem; each problem is listed once, with the first cell that has it.
    """
    names, costs = np.empty(len(plan), dtype="S24"), np.empty(len(plan), dtype=np.int64)
    calibrations: set[int] = set()
    problems: dict[str, tuple[int, int]] = {}  # first cell that has the problem, and number of such cells
    first: RunConfig | None = None
    memory = 0.0
    resolved = Resolved()
    assembled: dict[tuple[str, bytes], ConfigError | None] = {}
    progress.begin("checking", len(plan), "cells")
    for block in plan.blocks():
        cells = slice(block.cells.start, block.cells.stop, block.cells.step)
        try:
            job = check_job(plan.composed(block.cells[0]))
            costs[cells] = job.ticks
            if isinstance(job, CalibrationJob):
                calibrations.add(block.cells[0])
                names[cells] = job.name
                continue
            config, composed = job.config, job.config.composed
            first = first or config
            if _shared(first) != _shared(config):
                raise ConfigError(
                    "outputs, sweep.*, limits.*, caveats.*, spec.*: must have one value in all runs of a sweep"
                )
            _check_assembly(config, assembled)
            alike = None if block.seeds is None else store.run_hashes(config.resolved, config.arm.urdf, block.seeds)
            names[cells] = job.name if alike is None else alike.texts
            repetitions = config.settings.repetitions
            memory = max(memory, memory_of_run(config.arm, config.timing.ticks, repetitions, config.has_contact))
            start = config.path.start.tolist() if is_one_arm(composed.resolved) else None
            described = resolve(composed.resolved, config.timing.step, start)
            resolved.add(described, composed.overrides, block.cells)
        except ConfigError as error:
            for problem in error.problems:
                place, count = problems.get(problem, (block.cells[0], 0))
                problems[problem] = min(place, block.cells[0]), count + len(block.cells)
        finally:
            progress.step(len(block.cells))
    if problems or first is None:
        _report(plan, problems)
    outputs = Path(first.settings.outputs)
    return Checked(Names(names), costs, frozenset(calibrations), outputs, first, resolved, memory)


def _report(plan: Plan, problems: Mapping[str, tuple[int, int]]) -> NoReturn:
    """Raise an error with the problems in the order of the cells."""
    found = sorted(problems.items(), key=lambda item: item[1][0])
    more = len(found) - _PROBLEMS_SHOWN
    hint = "  nothing was started" if more <= 0 else f"  and {more} more problems; nothing was started"
    raise ConfigError([_describe(plan, problem, *where) for problem, where in found[:_PROBLEMS_SHOWN]], hint)


def _shared(config: RunConfig) -> tuple[object, ...]:
    """Return the parts that must be equal in all runs of a sweep."""
    return config.settings.outputs, config.sweep, config.limits, config.caveats, config.spec


def _check_assembly(config: RunConfig, assembled: dict[tuple[str, bytes], ConfigError | None]) -> None:
    """Assemble each robot with each plant and start once; some problems appear only during assembly."""
    parts = [json_text(config.resolved[group]) for group in ("robot", "plant")]
    key = ", ".join(parts), config.path.start.tobytes()
    if key not in assembled:
        assembled[key] = None
        try:
            check_assembly(config)
        except ConfigError as error:
            assembled[key] = error
    problem = assembled[key]
    if problem is not None:
        raise problem


def _describe(plan: Plan, problem: str, cell: int, count: int) -> str:
    others = f" and {count - 1} other cell{'s' if count > 2 else ''}:" if count > 1 else ""
    return f"[{' '.join(plan.overrides(cell))}]{others} {problem}"
