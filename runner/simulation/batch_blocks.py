"""Batch simulation of the repetitions of one compiled run, in blocks on several threads.

A block takes bounded memory, whatever the number of repetitions. Compiled ticks, random draws and array operations
release Python's lock for most of the time, so that threads use the cores. Stored results do not depend on the blocks
or the number of threads.
"""

import os
import time
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from runner.config.limits import TICKS_AT_ONCE
from runner.plugins.discovery import has_users_parts
from runner.simulation.batch import BatchSimulator
from runner.simulation.batch_jobs import Job, Simulated, simulate_together
from runner.simulation.result import RunResult, timing

MOST_THREADS = 4
"""More would wait for each other."""

TICKS = TICKS_AT_ONCE // MOST_THREADS
"""Ticks of a block, about: a tenth of a second."""

_AHEAD = 2  # blocks for each thread that are under way or wait to be taken


def simulate_blocks(job: Job, threads: int = 1, ticks: int = TICKS) -> RunResult | None:
    """Simulate a run; None where one of its repetitions is not compiled as a whole.

    Args:
        job: Its checked config, and what that was checked from.
        threads: Number of threads; with 1, or where a repetition has more ticks than a block, the caller's own.
        ticks: Ticks of a block, about.

    Raises:
        ConfigError: see assemble.
    """
    wall, cpu = time.perf_counter(), time.process_time()
    config, batcher = job[0], BatchSimulator()
    count, size = config.settings.repetitions, max(1, ticks // config.timing.ticks)
    blocks = [range(start, min(start + size, count)) for start in range(0, count, size)]
    threads = threads if config.timing.ticks <= ticks else 1
    simulate = partial(_simulate, job, batcher)
    first = simulate(blocks[0])  # alone: it makes what all have in common
    if first is None:
        return None
    names, failure, values = first.names, first.failure, np.zeros((0, count))
    for block, run in zip(blocks, chain([first], _in_order(simulate, blocks[1:], threads)), strict=True):
        if run is None:
            return None
        if run.names and not len(values):
            names, values = run.names, np.full((len(run.names), count), np.nan)
        if run.names:
            values[:, block.start : block.stop] = run.values.T
        if run is not first:
            first.watch.join(run.watch)
        failure = failure or run.failure
    result = replace(first, names=names, values=values.T, failure=failure).result()
    clock = timing(result.trace.tick_seconds, time.perf_counter() - wall, time.process_time() - cpu)
    return replace(result, timing=clock)


def _simulate(job: Job, batcher: BatchSimulator, block: range) -> Simulated | None:
    """Simulate some repetitions of a run; see simulate_blocks."""
    runs = batcher.repetitions(job[0], block)
    if runs is None:
        return None
    ((run,),) = [found for found in simulate_together([job], [runs], batcher) if found]
    return run


def _in_order(simulate: partial[Simulated | None], blocks: Sequence[range], threads: int) -> Iterator[Simulated | None]:
    """Yield blocks in order as they are simulated, some of them at the same time."""
    if threads == 1 or len(blocks) < 2:
        yield from map(simulate, blocks)
        return
    under_way: deque[Future[Simulated | None]] = deque()
    pool = ThreadPoolExecutor(threads)
    try:
        for block in blocks:
            under_way.append(pool.submit(simulate, block))
            if len(under_way) >= _AHEAD * threads:
                yield under_way.popleft().result()
        while under_way:
            yield under_way.popleft().result()
    finally:  # Ctrl-C waits for the blocks under way alone
        pool.shutdown(cancel_futures=True)


def threads_allowed() -> int:
    """Return how many threads simulate a run; parts of the user's are asked by one alone."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return 1 if has_users_parts() else min(cores, MOST_THREADS)
