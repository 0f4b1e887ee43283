"""What is to be made: cells, each with its config; composed, checked and named before anything starts."""

import itertools
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from tqdm import tqdm

from runner import store
from runner.assembly import assemble
from runner.calibration_job import CALIBRATION
from runner.config.calibration import validate_calibration
from runner.config.compose import Composed
from runner.config.limits import LimitsConfig
from runner.config.run import RunConfig
from runner.config.sweep import SweepConfig
from runner.config.validation import validate
from runner.errors import ConfigError
from runner.sweeps.differing import Resolved
from runner.sweeps.resolved import is_one_arm, resolve

_PROBLEMS_SHOWN = 20
_TICKS_OF_A_CALIBRATION = 200  # that take as long as one repetition of it


class Plan(Protocol):
    """Runs and calibrations to make, counted as cells."""

    def __len__(self) -> int:
        """Return the number of cells."""
        ...

    def overrides(self, cell: int) -> tuple[str, ...]:
        """Return the overrides of a cell, as typed; what only says how and where it is made is left out."""
        ...

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell.

        Raises:
            ConfigError: if it does not compose.
        """
        ...


@dataclass(frozen=True)
class Checked:
    """What the check of a plan gave.

    Attributes:
        names: Hash of each cell's run or calibration.
        costs: Ticks of all its repetitions together.
        calibrations: The cells that are calibrations, not runs.
        outputs: Folder in which they are stored.
        settings: How the runs are made.
        limits: What they may cost.
        resolved: What differs between the configs of the runs.
    """

    names: Sequence[str]
    costs: Sequence[int]
    calibrations: frozenset[int]
    outputs: Path
    settings: SweepConfig
    limits: LimitsConfig
    resolved: Resolved


def check(plan: Plan) -> Checked:
    """Compose and check all cells of a plan, one of which is a run.

    Raises:
        ConfigError: telling each problem once, with the first cell that has it.
    """
    names: list[str] = []
    costs: list[int] = []
    calibrations: set[int] = set()
    problems: dict[str, list[int]] = {}
    first: RunConfig | None = None
    resolved = Resolved()
    assembled: dict[str, ConfigError | None] = {}
    for cell in tqdm(range(len(plan)), desc="checking", unit="run", delay=1.0, disable=None):
        try:
            composed = plan.composed(cell)
            if composed.root == CALIBRATION:
                calibrations.add(cell)
                name, cost = _check_calibration(composed)
            else:
                config = validate(composed.resolved, composed.config_dirs)
                first = first or config
                _check_alike(first, config)
                _check_assembly(composed, config, assembled)
                name = store.run_hash(composed.resolved, config.arm.urdf)
                cost = config.timing.ticks * config.settings.repetitions
                start = config.path.start.tolist() if is_one_arm(composed.resolved) else None
                resolved.add(resolve(composed.resolved, config.timing.step, start), composed.overrides)
            names.append(name)
            costs.append(cost)
        except ConfigError as error:
            for problem in error.problems:
                problems.setdefault(problem, []).append(cell)
    if problems or first is None:
        shown = itertools.islice(problems.items(), _PROBLEMS_SHOWN)
        more = len(problems) - _PROBLEMS_SHOWN
        hint = "  nothing was started" if more <= 0 else f"  and {more} more problems; nothing was started"
        raise ConfigError([_describe(plan, *item) for item in shown], hint)
    outputs = Path(first.settings.outputs)
    return Checked(names, costs, frozenset(calibrations), outputs, first.sweep, first.limits, resolved)


def _check_calibration(composed: Composed) -> tuple[str, int]:
    """Return hash and cost of a calibration."""
    config = validate_calibration(composed)
    name = store.run_hash(config.resolved, config.arm.urdf)
    return name, _TICKS_OF_A_CALIBRATION * config.settings.repetitions


def _check_alike(first: RunConfig, other: RunConfig) -> None:
    if _shared(first) != _shared(other):
        raise ConfigError(["outputs, sweep.*, limits.*, caveats.*: must have one value in all runs of a sweep"])


def _shared(config: RunConfig) -> tuple[object, ...]:
    """Return what is the same in all runs of a sweep."""
    return config.settings.outputs, config.sweep, config.limits, config.caveats


def _check_assembly(composed: Composed, config: RunConfig, assembled: dict[str, ConfigError | None]) -> None:
    """Assemble each robot on each plant from each start once: some problems show only there."""
    parts = [composed.resolved[group] for group in ("robot", "plant")]
    key = json.dumps([*parts, config.path.start.tolist()])
    if key not in assembled:
        assembled[key] = None
        try:
            assemble(config).close()
        except ConfigError as error:
            assembled[key] = error
    problem = assembled[key]
    if problem is not None:
        raise problem


def _describe(plan: Plan, problem: str, cells: Sequence[int]) -> str:
    others = f" and {len(cells) - 1} other cells:" if len(cells) > 1 else ""
    return f"[{' '.join(plan.overrides(cells[0]))}]{others} {problem}"
