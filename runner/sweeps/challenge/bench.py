"""Runs of a challenge: both sides of several changes on blocks of fresh seeds."""

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from runner.config.compose.composer import Composer
from runner.config.compose.files import outputs_override
from runner.statistics.scope import LOOKS
from runner.store.finished import Finished
from runner.sweeps.challenge.case import Case
from runner.sweeps.challenge.changed import Cell, Changed
from runner.sweeps.challenge.drawn import Drawn, join, read_drawn
from runner.sweeps.challenge.question import Question
from runner.sweeps.check import check
from runner.sweeps.run import Engine, make_missing, make_rules
from runner.sweeps.writer import TraceKeeping


class HasOverrides(Protocol):
    """Overrides that both sides get.

    Attributes:
        sides: Those of A and of B.
        exact: True if neither side draws anything with them.
    """

    @property
    def sides(self) -> Sequence[Sequence[str]]: ...  # noqa: D102
    @property
    def exact(self) -> bool: ...  # noqa: D102


class PairBench:
    """Simulates both sides of changes, and keeps what it has simulated.

    Args:
        case: The asked case.
        question: Its question.
        composer: Composer of the configs.
        keys: Keys that some run changes.
        folder: Folder of the challenge.
        outputs: The outputs folder.
        engine: Location of the execution.
        command: Random name of the command; see `at_work`.

    Attributes:
        jobs: Overrides and hash of each run.
        end: Time of `time.monotonic` after which no run starts.
    """

    def __init__(
        self,
        case: Case,
        question: Question,
        composer: Composer,
        keys: Sequence[str],
        folder: Path,
        outputs: Path,
        engine: Engine,
        command: str,
    ) -> None:
        self._case, self._keys, self._folder, self._outputs, self._engine = case, keys, folder, outputs, engine
        self._question, self._composer, self._command = question, composer, command
        self._drawn: dict[Cell, Drawn] = {}
        self._names: dict[Cell, str] = {}
        self.jobs: list[tuple[Sequence[str], str]] = []
        self.end = math.inf
        self._size = 0

    @property
    def is_over(self) -> bool:
        """True if no further run may start."""
        return time.monotonic() >= self.end

    @property
    def turning_block(self) -> int:
        """Number of the block of seeds for turning values, after those of all looks."""
        return int(1 << (LOOKS - 1))

    def draw(
        self, changes: Sequence[HasOverrides], size: int, blocks: int, first: int = 0
    ) -> list[tuple[Drawn, Drawn]]:
        """Return the draws of A and B for some changes; none if the time is over.

        Args:
            changes: The changes.
            size: Number of draws in a block, the repetitions of a run; one if nothing is drawn.
            blocks: Number of blocks; each has another seed.
            first: Number of the first block.
        """
        if self.is_over:
            return []
        self._size = self._size or size
        cells = [self._cells(change, size, blocks, first) for change in changes]
        wanted = dict.fromkeys(cell for both in cells for side in both for cell in side)
        self._simulate([cell for cell in wanted if cell not in self._drawn], "never")
        joined = [[join([self._drawn[cell] for cell in side]) for side in both] for both in cells]
        return [(a, b) for a, b in joined]

    def names_of(self, change: HasOverrides) -> list[str]:
        """Return the runs of both sides of a change on the first block."""
        return [self._names[side[0]] for side in self._cells(change, self._size, 1) if side[0] in self._names]

    def keep_traces(self, changes: Sequence[HasOverrides]) -> None:
        """Simulate some changes on the first block again, with their traces."""
        cells = [side[0] for change in changes for side in self._cells(change, self._size, 1)]
        self._simulate(list(dict.fromkeys(cells)), "all")

    def _cells(self, change: HasOverrides, size: int, blocks: int, first: int = 0) -> list[list[Cell]]:
        """Return the runs of A, and of B, one for each block."""
        seeds = [self._question.seed + first + block for block in range(1 if change.exact else blocks)]
        repetitions = f"repetitions={1 if change.exact else size}"
        sides = enumerate(change.sides)
        return [[(side, (*more, f"seed={seed}", repetitions)) for seed in seeds] for side, more in sides]

    def _simulate(self, cells: Sequence[Cell], trace: TraceKeeping) -> None:
        if not cells:
            return
        shared = [outputs_override(self._outputs)]
        plan = Changed(self._case, cells, self._keys, shared, self._composer)
        checked = check(plan)
        rules = replace(make_rules(checked.first.sweep, self._folder, len(plan), self._command), trace=trace)
        make_missing(plan, checked, rules, self._engine, lambda _: None)
        finished = Finished(self._outputs)
        for number, (cell, name) in enumerate(zip(cells, checked.names, strict=True)):
            if cell not in self._names:
                self.jobs.append((plan.overrides(number), name))
            self._names[cell] = name
            self._drawn[cell] = read_drawn(finished.open(name), self._question.metric)
