"""Queue of runs and calibrations, handed out in chunks."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from runner import store
from runner.config.composed import Composed
from runner.store.shards import next_number, shard_name
from runner.sweeps.work import Chunk, ChunkResult, SeedPart, find_stored
from runner.sweeps.writer import Rules

_SECONDS_PER_CHUNK = 1.0  # long against the 5 ms that a chunk costs, short against a sweep
_MOST_CHUNKS = 2000  # at most, however slow the jobs are: a chunk may be a file
_LARGEST = 2000  # jobs; if a worker dies, a longer chunk would lose too much
_SHORTEST_TICK = 1e-7  # s; a cached job takes no time


Alike = Callable[[Sequence[int]], Iterable[tuple[Sequence[int], Sequence[Composed]]]]
"""Function that yields groups of cells whose configs differ only in the seed, with their configs; see Plan.alike."""


class Queue:
    """Queue of chunks that take about a second each, or longer if there would be too many; suspects come last.

    The first chunks are single jobs, until the time for a job is known.

    Args:
        alike: Method of the sweep's plan that yields the configs of cells.
        names: Hash of each cell's run or calibration.
        costs: Cost of each cell, in ticks.
        cells: Cells of the pending jobs, in order, shape (n,).
        rules: Rules for the execution and storage of the jobs.

    Attributes:
        rules: Rules for the execution and storage of the jobs.
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
        self._ticks_of: dict[str, int] = {}  # finished ticks of each chunk in flight
        self._alike, self._names, self._costs = alike, names, costs
        self._cells, self._next = cells, 0
        of_each = np.asarray(costs, dtype=np.int64)[cells]
        self._ticks = np.concatenate([[0], np.cumsum(of_each)])  # cumulative ticks before each pending cell
        self._fewest = -(-len(names) // _MOST_CHUNKS)
        self._under_way: dict[str, int] = {}
        self._suspects = deque[int]()
        self._number = next_number(rules.outputs)
        self._handed_out = 0
        self._seconds_per_tick: float | None = None

    @property
    def left(self) -> int:
        """Number of jobs that have not been handed out."""
        return len(self._cells) - self._next

    def put(self, cell: int) -> None:
        """Append a cell."""
        self._cells = np.append(self._cells[self._next :], cell)
        self._ticks = np.append(self._ticks[self._next :], self._ticks[-1] + self._costs[cell])
        self._next = 0

    def take(self, workers: int) -> Chunk | None:
        """Return the next chunk, or None if the queue is empty; `workers` share the pending jobs."""
        start, ticks = self._next, self._ticks
        if start == len(self._cells):
            return None
        stop = start + 1
        if self._seconds_per_tick is not None:
            left = ticks[-1] - ticks[start]
            fair = left if workers == 1 else (ticks[-1] - ticks[stop]) / (2 * workers)
            budget = min(_SECONDS_PER_CHUNK / self._seconds_per_tick, fair)
            affordable = int(np.searchsorted(ticks, ticks[start] + budget, side="right")) - 1
            stop = min(max(affordable, start + self._fewest, stop), start + _LARGEST, len(self._cells))
        self._next = stop
        return self._chunk(self._cells[start:stop].tolist())

    def take_suspect(self) -> Chunk | None:
        """Return the next suspect as a chunk with a single run; if its worker dies again, the suspect is the cause."""
        return self._chunk([self._suspects.popleft()]) if self._suspects else None

    def tell(self, chunk: str, ticks: int) -> None:
        """Update the number of finished ticks of a chunk in flight, given by its name; any thread may call this."""
        if chunk in self._ticks_of:
            self._ticks_of[chunk] = ticks

    def end(self, chunk: Chunk) -> None:
        """Remove a chunk that is no longer in flight."""
        self._ticks_of.pop(chunk.name)

    @property
    def ticks_made(self) -> int:
        """Number of ticks of the finished jobs, plus the finished ticks of the chunks in flight."""
        return self._ticks_done + sum(list(self._ticks_of.values()))

    def learn(self, report: ChunkResult) -> None:
        """Update the progress and the time for a tick from the report of a chunk."""
        ticks = sum(int(self._costs[self._under_way.pop(end.name)]) for end in report.outcomes)
        self._ticks_done += ticks
        if ticks and report.seconds:
            seconds = max(report.seconds / ticks, _SHORTEST_TICK)
            known = self._seconds_per_tick
            self._seconds_per_tick = seconds if known is None else 0.5 * (known + seconds)

    def give_back(self, chunk: Chunk, as_suspects: bool = True) -> list[store.RunOutcome]:
        """Queue the unfinished jobs of a chunk again; return the outcomes of its stored jobs.

        Args:
            chunk: The chunk.
            as_suspects: True if its worker died: then each unfinished job may be the cause, and is made separately.
        """
        done = []
        known = find_stored(chunk)
        for name in chunk.names:
            if name in known:
                done.append(known[name])
            elif as_suspects:
                self._suspects.append(self._under_way.pop(name))
            else:
                self.put(self._under_way.pop(name))
        return done

    def _chunk(self, cells: Sequence[int]) -> Chunk:
        self._handed_out += 1
        parts = []
        for own, configs in self._alike(cells):
            names = [self._names[cell] for cell in own]
            self._under_way |= dict(zip(names, own, strict=True))
            parts.append(SeedPart(names, configs))
        name = shard_name(self._number, self.rules.command, self._handed_out)
        self._ticks_of[name] = 0
        return Chunk(name, self.rules, parts)
