"""Queue of runs and calibrations, handed out in chunks."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from runner import store
from runner.config.compose.compose import Composed
from runner.store.shards import next_number, shard_name
from runner.sweeps.work import Chunk, Part, Report, find_stored
from runner.sweeps.writer import Rules

_SECONDS_PER_CHUNK = 1.0  # long against the 5 ms that a chunk costs, short against a sweep
_MOST_CHUNKS = 2000  # that take as many jobs each as it needs, however slow these are: a chunk may be a file
_LARGEST = 2000  # jobs; of longer chunks much would be lost with their worker
_SHORTEST_TICK = 1e-7  # s; what was found stored takes none


Alike = Callable[[Sequence[int]], Iterable[tuple[Sequence[int], Sequence[Composed]]]]
"""Gives those of some cells whose configs differ in nothing but the seed, with their configs; see Plan.alike."""


class Queue:
    """Chunks that take about a second each, or more where there would be too many; suspects come last.

    They are single jobs at first, until it is known how long one takes.

    Args:
        alike: Gives their configs: that of the sweep's plan.
        names: Hash of each cell's run or calibration.
        costs: What each cell costs, in ticks.
        cells: The cells to do, in their order, shape (n,).
        rules: How they are made and kept.

    Attributes:
        rules: As given.
    """

    def __init__(
        self,
        alike: Alike,
        names: Sequence[str],
        costs: "Sequence[int] | NDArray[np.int64]",
        cells: NDArray[np.intp],
        rules: Rules,
    ) -> None:
        self.rules, self._ticks_done = rules, 0
        self._ticks_of: dict[str, int] = {}  # made so far of each chunk under way
        self._alike, self._names, self._costs = alike, names, costs
        self._cells, self._next = cells, 0
        of_each = np.asarray(costs, dtype=np.int64)[cells]
        self._ticks = np.concatenate([[0], np.cumsum(of_each)])  # of all cells before each that is to do
        self._fewest = -(-len(names) // _MOST_CHUNKS)
        self._under_way: dict[str, int] = {}
        self._suspects = deque[int]()
        self._number = next_number(rules.outputs)
        self._handed_out = 0
        self._seconds_per_tick: float | None = None

    @property
    def left(self) -> int:
        """Number of jobs that are not handed out."""
        return len(self._cells) - self._next

    def put(self, cell: int) -> None:
        """Put one more cell at the end."""
        self._cells = np.append(self._cells[self._next :], cell)
        self._ticks = np.append(self._ticks[self._next :], self._ticks[-1] + self._costs[cell])
        self._next = 0

    def take(self, workers: int) -> Chunk | None:
        """Return the next chunk, or None when none is left; `workers` share what is left."""
        start, ticks = self._next, self._ticks
        if start == len(self._cells):
            return None
        stop = start + 1
        if self._seconds_per_tick is not None:
            fair = (ticks[-1] - ticks[stop]) / (2 * workers)
            budget = min(_SECONDS_PER_CHUNK / self._seconds_per_tick, fair)
            affordable = int(np.searchsorted(ticks, ticks[start] + budget, side="right")) - 1
            stop = min(max(affordable, start + self._fewest, stop), start + _LARGEST, len(self._cells))
        self._next = stop
        return self._chunk(self._cells[start:stop].tolist())

    def take_suspect(self) -> Chunk | None:
        """Return the next run whose workers died, as a chunk; made alone, it shows whether it is the cause."""
        return self._chunk([self._suspects.popleft()]) if self._suspects else None

    def tell(self, chunk: str, ticks: int) -> None:
        """Take note, from any thread, of how many ticks of a chunk under way are made, given by its name."""
        if chunk in self._ticks_of:
            self._ticks_of[chunk] = ticks

    def end(self, chunk: Chunk) -> None:
        """Take note that a chunk is no longer under way."""
        self._ticks_of.pop(chunk.name)

    @property
    def ticks_made(self) -> int:
        """What the jobs cost that have ended, in ticks, and the ticks made of those under way."""
        return self._ticks_done + sum(list(self._ticks_of.values()))

    def learn(self, report: Report) -> None:
        """Take note of what ended, and of how long it took."""
        ticks = sum(int(self._costs[self._under_way.pop(end.name)]) for end in report.outcomes)
        self._ticks_done += ticks
        if ticks and report.seconds:
            seconds = max(report.seconds / ticks, _SHORTEST_TICK)
            known = self._seconds_per_tick
            self._seconds_per_tick = seconds if known is None else 0.5 * (known + seconds)

    def give_back(self, chunk: Chunk) -> list[store.Outcome]:
        """Take back a chunk whose workers died: its runs are suspects; return how those ended that are stored."""
        done = []
        known = find_stored(chunk)
        for name in chunk.names:
            if name in known:
                done.append(known[name])
            else:
                self._suspects.append(self._under_way.pop(name))
        return done

    def _chunk(self, cells: Sequence[int]) -> Chunk:
        self._handed_out += 1
        parts = []
        for own, configs in self._alike(cells):
            names = [self._names[cell] for cell in own]
            self._under_way |= dict(zip(names, own, strict=True))
            parts.append(Part(names, configs))
        name = shard_name(self._number, self._handed_out)
        self._ticks_of[name] = 0
        return Chunk(name, self.rules, parts)
