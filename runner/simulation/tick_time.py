"""Measured time for a tick of a run."""

import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace

from runner.assembly.assemble import assemble
from runner.assembly.run_config import RunConfig
from runner.plugins.discovery import added_parts
from runner.simulation.batch import BatchSimulator, simulate_together
from runner.simulation.by_ticks import simulate_assembled

PROBED_TICKS = 50
"""Number of ticks for a measurement of the time for a tick, if a run is simulated separately."""

_PROBED_TOGETHER = 100_000  # ticks, if repetitions are simulated together
_LONG = 0.5  # s; a longer measurement is not repeated
_NO_DEADLINE: AbstractContextManager[None] = nullcontext()


def seconds_per_tick(
    config: RunConfig,
    within: AbstractContextManager[None] = _NO_DEADLINE,
    clock: Callable[[], float] = time.perf_counter,
) -> float:
    """Return the time for a tick of a run, in s, measured on its first ticks.

    Args:
        config: The checked config.
        within: Context of the measurement, entered after assembly and compilation; it may end the measurement.
        clock: Function that returns the time, in s.
    """
    together = seconds_together(config, _PROBED_TOGETHER, within, clock)
    if together is not None:
        return together
    closed = assemble(config)
    part = replace(closed, ticks=min(closed.ticks, PROBED_TICKS))
    try:
        with within:
            return warm_time(lambda: simulate_assembled(part, config, 0), clock) / (part.ticks + 1)
    finally:
        closed.close()


def seconds_together(
    config: RunConfig,
    ticks: int,
    within: AbstractContextManager[None] = _NO_DEADLINE,
    clock: Callable[[], float] = time.perf_counter,
) -> float | None:
    """Return the time for a tick of a run in a batch, in s; None if the run cannot be simulated in a batch.

    It is also None with metrics of a plug-in, so that a measurement does not call them.

    Args:
        config: The checked config.
        ticks: Approximate number of ticks to simulate, twice if they are fast.
        within: See `seconds_per_tick`.
        clock: See `seconds_per_tick`.
    """
    if added_parts("metric"):
        return None
    batcher = BatchSimulator()
    repetitions = range(min(config.settings.repetitions, max(1, ticks // config.timing.ticks)))
    runs = batcher.repetitions(config, repetitions)
    if runs is None:
        return None
    runs = [run.first(ticks) for run in runs]
    simulated = sum(run.config.timing.ticks for run in runs)
    copies = max(1, ticks // simulated)

    def simulate_copies() -> None:
        for _ in simulate_together([runs] * copies, batcher):
            pass

    with within:
        return warm_time(simulate_copies, clock) / (copies * simulated)


def warm_time(measured: Callable[[], object], clock: Callable[[], float]) -> float:
    """Return the time that a function takes, in s: in its second call, unless the first takes long."""
    took = 0.0
    for _ in range(2):
        if took < _LONG:
            start = clock()
            measured()
            took = clock() - start
    return took
