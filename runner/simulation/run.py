"""Simulation and measurement of the repetitions of one run.

Repetitions that are compiled as a whole are simulated together, in blocks on several threads. The memory of a block
does not depend on the number of repetitions. Compiled ticks, random draws and array operations mostly release Python's
lock, so threads use several cores. Results do not depend on the blocks or the number of threads.
"""

import os
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np

from runner.assembly.assemble import assemble
from runner.assembly.drawn_loops import with_drawn
from runner.assembly.run_config import RunConfig
from runner.assembly.run_cost import TICKS_AT_ONCE
from runner.assembly.validation import validate
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.trace import Trace
from runner.caveats import rounding_growth
from runner.caveats.integration_error import COMPARED, PlantError, compare, on_runge_kutta, reason_not_comparable
from runner.caveats.monitor import Watch
from runner.caveats.rounding_growth import RoundingGrowth, move_start
from runner.caveats.setting import setting_of
from runner.config.parsing import require
from runner.plugins.discovery import has_users_parts
from runner.sensing.streams import ROUNDING
from runner.simulation.batch import BatchResult, BatchSimulator, simulate_together
from runner.simulation.by_ticks import simulate_assembled, simulate_by_ticks
from runner.simulation.results import Collector, RunResult, measure_repetition, metric_context

MOST_THREADS = 4
"""Largest number of threads; more would wait for each other."""

TICKS = TICKS_AT_ONCE // MOST_THREADS
"""Approximate number of ticks of a block, which take a tenth of a second."""

_DRAWN = 32  # nominal models that are drawn together
_AHEAD = 2  # blocks of each thread, running or queued


def simulate_run(config: RunConfig, threads: int = 1) -> RunResult:
    """Simulate the repetitions of a checked config.

    Args:
        config: The checked config.
        threads: Number of threads for a run that is compiled as a whole.

    Raises:
        ConfigError: if the start of the trajectory cannot be reached, or a component rejects its config.
    """
    return simulate_blocks(config, threads) or _simulate_one_by_one(config)


def simulate_repetition(
    config: RunConfig, repetition: int = 0, ticks: int | None = None, signs: FloatArray | None = None
) -> Trace:
    """Simulate one repetition.

    Args:
        config: The checked config.
        repetition: Number of the repetition.
        ticks: Largest number of ticks; None for all.
        signs: Signs with which the joints start from moved positions, shape (nq,), see `move_start`; None for the start
            of the run.

    Raises:
        ConfigError: see assemble.
    """
    ticks = config.timing.ticks if ticks is None else min(ticks, config.timing.ticks)
    batcher = BatchSimulator()
    runs = batcher.repetitions(config, range(repetition, repetition + 1))
    if runs is not None:
        q_start = runs[0].q_start if signs is None else move_start(runs[0].q_start, signs)
        (found,) = batcher.simulate([replace(runs[0], q_start=q_start).first(ticks)])
        return found.traces[0] if isinstance(found, BatchResult) else found[1]
    return simulate_by_ticks(config, repetition, ticks, lambda q: q if signs is None else move_start(q, signs))


def _simulate_one_by_one(config: RunConfig) -> RunResult:
    """Simulate a run whose repetitions are not compiled as a whole."""
    wall, cpu = time.perf_counter(), time.process_time()
    loop, context, repetitions = assemble(config), metric_context(config), config.settings.repetitions
    watch = Watch(setting_of(config, loop.q_start), config.caveats)
    collector = Collector(config, watch, repetitions, np.zeros((repetitions, 0)))
    warnings: list[str] = []
    try:
        for repetition in range(repetitions):
            if repetition % _DRAWN == 0:
                drawn = with_drawn(loop, config, range(repetition, min(repetition + _DRAWN, repetitions)))
            if drawn is not None:
                loop = drawn[repetition % _DRAWN]
            elif repetition > 0 and config.varies_model:  # new model
                last, loop = loop, assemble(config, repetition)
                last.close()
            trace, told = simulate_assembled(loop, config, repetition)
            warnings = warnings or told
            collector.evaluate(repetition, trace, context)
    finally:
        loop.close()
    clock = {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu}
    return _compared(collector, warnings, clock)


def _compared(collector: Collector, warnings: Sequence[str], clock: Mapping[str, float]) -> RunResult:
    """Return the result of a complete run, with its integration error and growth of rounding errors if asked for."""
    config, growth = collector.config, None
    if config.settings.plant_error:
        growth = measure_rounding(config, (require(collector.trace), collector.of_first()))
    return collector.result(_plant_error(collector), growth, warnings, clock)


def _plant_error(collector: Collector) -> PlantError | None:
    """Return the integration error in repetition 0; None if it is disabled or the plant cannot be compared."""
    config, trace = collector.config, collector.trace
    if not config.settings.plant_error or config.plant.kind not in COMPARED or trace is None:
        return None
    if reason := reason_not_comparable(config.environment.kind):
        return PlantError(None, reason)
    try:
        other = validate(replace(config.composed, resolved=on_runge_kutta(config.resolved)))
        made = simulate_run(other)
    except ConfigError as error:
        return PlantError(None, str(error))
    theirs = {name: summary.median for name, summary in made.metrics.items()}
    return compare(trace, collector.of_first(), made.trace, theirs, config.robot.settling_band, other.timing.step)


def measure_rounding(
    config: RunConfig, own: tuple[Trace, Mapping[str, float | None]] | None = None, draw: int = 0
) -> RoundingGrowth:
    """Compare repetition 0 with the same repetition from a start moved by rounding errors.

    Args:
        config: The checked config.
        own: Trace and metrics of repetition 0; None if they are to be simulated.
        draw: Number of the draw of signs.

    Raises:
        ConfigError: see assemble.
    """
    context = metric_context(config)
    signs = np.random.default_rng([config.settings.seed, draw, ROUNDING]).choice([-1.0, 1.0], config.arm.model.nq)
    moved = measure_repetition(simulate_repetition(config, signs=signs), context, [])
    return rounding_growth.compare(*(own or measure_repetition(simulate_repetition(config), context, [])), *moved)


def simulate_blocks(config: RunConfig, threads: int = 1, ticks: int = TICKS) -> RunResult | None:
    """Simulate a run in blocks of repetitions; None if one of its repetitions is not compiled as a whole.

    Args:
        config: The checked config.
        threads: Number of threads; with 1, or if a repetition has more ticks than a block, the caller's thread.
        ticks: Approximate number of ticks of a block.

    Raises:
        ConfigError: see assemble.
    """
    wall, cpu = time.perf_counter(), time.process_time()
    batcher, count, size = BatchSimulator(), config.settings.repetitions, max(1, ticks // config.timing.ticks)
    blocks = [range(start, min(start + size, count)) for start in range(0, count, size)]
    threads = threads if config.timing.ticks <= ticks else 1
    simulate_block = partial(_simulate_block, config, batcher)
    whole = simulate_block(blocks[0])  # first, because it computes the shared results
    if whole is None:
        return None
    whole.reserve(count)
    for run in _in_order(simulate_block, blocks[1:], threads):
        if run is None:
            return None
        whole.join(run)
    clock = {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu}
    return _compared(whole, (), clock)


def _simulate_block(config: RunConfig, batcher: BatchSimulator, block: range) -> Collector | None:
    runs = batcher.repetitions(config, block)
    if runs is None:
        return None
    ((run,),) = [found for found in simulate_together([runs], batcher) if found]
    return run


def _in_order(
    simulate_block: "partial[Collector | None]", blocks: Sequence[range], threads: int
) -> Iterator[Collector | None]:
    """Yield simulated blocks in order, computed on several threads."""
    if threads == 1 or len(blocks) < 2:
        yield from map(simulate_block, blocks)
        return
    in_flight: deque[Future[Collector | None]] = deque()
    pool = ThreadPoolExecutor(threads)
    try:
        for block in blocks:
            in_flight.append(pool.submit(simulate_block, block))
            if len(in_flight) >= _AHEAD * threads:
                yield in_flight.popleft().result()
        while in_flight:
            yield in_flight.popleft().result()
    finally:  # Ctrl-C waits only for the blocks in flight
        pool.shutdown(cancel_futures=True)


def threads_allowed() -> int:
    """Return the number of threads that may simulate a run; plug-ins run in one thread only."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return 1 if has_users_parts() else min(cores, MOST_THREADS)
