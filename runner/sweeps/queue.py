"""The runs and calibrations that are still to do, handed out in chunks."""

from collections import deque
from collections.abc import Iterable, Sequence
from typing import Protocol

from runner import store
from runner.config.compose import Composed
from runner.store.shards import next_number, shard_name
from runner.sweeps.work import Chunk, Report, Rules, find_stored

_SECONDS_PER_CHUNK = 1.0  # long against the 5 ms that a chunk costs, short against a sweep
_LARGEST = 500
_SHORTEST_TICK = 1e-7  # s; what was found stored takes none


class Cells(Protocol):
    """What gives the cells of a queue, such as a plan."""

    def composed(self, cell: int) -> Composed:
        """Return the composed config of a cell."""


class Queue:
    """Chunks that take about a second each, single jobs at first and again when few are left; suspects come last.

    Args:
        cells_of: Gives their configs: the sweep's plan.
        names: Hash of each cell's run or calibration.
        costs: What each cell costs, in ticks.
        cells: The cells to do, in their order.
        rules: How they are made and kept.
    """

    def __init__(
        self, cells_of: Cells, names: Sequence[str], costs: Sequence[int], cells: Iterable[int], rules: Rules
    ) -> None:
        self.rules = rules
        self._cells_of, self._names, self._costs = cells_of, names, costs
        self._left, self._suspects = deque(cells), deque[int]()
        self._cell_of = {names[cell]: cell for cell in self._left}
        self._number = next_number(rules.outputs)
        self._handed_out = 0
        self._seconds_per_tick: float | None = None

    def cost(self, name: str) -> int:
        """Return what a run or calibration of the queue costs, in ticks."""
        return self._costs[self._cell_of[name]]

    def take(self, workers: int) -> Chunk | None:
        """Return the next chunk, or None when none is left; `workers` share what is left."""
        if not self._left:
            return None
        cells = [self._left.popleft()]
        if self._seconds_per_tick is not None:
            fair = sum(self._costs[cell] for cell in self._left) / (2 * workers)
            budget = min(_SECONDS_PER_CHUNK / self._seconds_per_tick, fair) - self._costs[cells[0]]
            while self._left and len(cells) < _LARGEST and self._costs[self._left[0]] <= budget:
                budget -= self._costs[self._left[0]]
                cells.append(self._left.popleft())
        return self._chunk(cells)

    def take_suspect(self) -> Chunk | None:
        """Return the next run whose workers died, as a chunk; made alone, it shows whether it is the cause."""
        return self._chunk([self._suspects.popleft()]) if self._suspects else None

    def learn(self, report: Report) -> None:
        """Take note of how long a chunk took."""
        ticks = sum(self.cost(end.name) for end in report.outcomes)
        if ticks:
            seconds = max(report.seconds / ticks, _SHORTEST_TICK)
            known = self._seconds_per_tick
            self._seconds_per_tick = seconds if known is None else 0.5 * (known + seconds)

    def give_back(self, chunk: Chunk) -> list[store.Outcome]:
        """Take back a chunk whose workers died: its runs are suspects; return how those ended that are stored."""
        done = []
        known = find_stored(chunk)
        for name, _ in chunk.jobs:
            if name in known:
                done.append(known[name])
            else:
                self._suspects.append(self._cell_of[name])
        return done

    def _chunk(self, cells: Sequence[int]) -> Chunk:
        self._handed_out += 1
        jobs = [(self._names[cell], self._cells_of.composed(cell)) for cell in cells]
        return Chunk(shard_name(self._number, self._handed_out), self.rules, jobs)
