"""Batch simulation of the runs of a chunk."""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from runner import store
from runner.assembly.run_config import RunConfig
from runner.base.errors import StoreError
from runner.base.machine import this_machine
from runner.config.settings import RunSettings
from runner.plugins.discovery import added_parts
from runner.plugins.metric_units import units_of
from runner.simulation.batch import BatchSimulator, simulate_together
from runner.simulation.provenance import command, job_provenance
from runner.simulation.results import Collector
from runner.store.seal import JsonTexts
from runner.store.shards import ShardRow, lists_values
from runner.sweeps.deadline import TimeLimitError, deadline
from runner.sweeps.records import record_texts
from runner.sweeps.writer import ResultWriter, Rules, without_trace

Named = tuple[str, Collector]


def make_together(
    jobs: Sequence[tuple[str, RunConfig]], rules: Rules, writer: ResultWriter, go_on: Callable[[], bool]
) -> tuple[set[str], bool]:
    """Simulate the runs of a chunk that can share a batch; return the names of the finished ones and if one failed.

    Runs with metrics of a plug-in are left out, and so are runs with too many repetitions for the record to list, and
    runs that are compared with others by `plant_error`. The caller simulates each of them on its own, block by block.

    If the batch raises an error, for example in a plug-in, the runs that are left are not simulated here. The caller
    simulates them one by one, which shows which run caused the error.

    Args:
        jobs: Name and checked config of each run.
        rules: Rules for the execution and storage of the runs; the time limit applies to runs that end together.
        writer: Writer of the finished runs.
        go_on: Function called before each batch; none starts after it has returned False.

    Raises:
        StoreError: if a run cannot be written.
    """
    batcher, texts, made, failed = BatchSimulator(), JsonTexts(), set[str](), False
    try:
        with deadline(rules.settings.time_limit):
            few = [] if added_parts("metric") else [job for job in jobs if _fits(job[1].settings)]
            found = [(name, batcher.repetitions(config)) for name, config in few]
        chosen = [(name, runs) for name, runs in found if runs is not None]
        steps = simulate_together([runs for _, runs in chosen], batcher)
        while go_on():
            with deadline(rules.settings.time_limit):
                complete = next(steps, None)
            if complete is None:
                break
            named = [(chosen[run.place][0], run) for run in complete]
            kept = [(n, run) for n, run in named if run.failure is not None or rules.keeps_trace(n, False)]
            names = {name for name, _ in kept}
            rows = list(_rows([(name, run) for name, run in named if name not in names], texts, batcher))
            writer.put_rows(rows)
            made.update(row.outcome.name for row in rows)
            for name, run in kept:
                failed = writer.put(name, without_trace(name, run.result(), rules)) or failed
                made.add(name)
    except StoreError:
        raise
    except (Exception, TimeLimitError):
        return made, failed
    return made, failed


def _fits(settings: RunSettings) -> bool:
    return lists_values(settings.repetitions) and not settings.plant_error


def _rows(runs: Iterable[Named], texts: JsonTexts, batcher: BatchSimulator) -> Iterator[ShardRow]:
    """Yield successful runs as rows of a shard."""
    alike: dict[tuple[object, ...], list[Named]] = {}
    for name, run in runs:
        alike.setdefault((run.names, len(run.values)), []).append((name, run))
    for some in alike.values():
        names, values = some[0][1].names, np.array([run.values for _, run in some])  # runs, repetitions, metrics
        if np.isinf(values).any():
            raise ValueError("a metric is infinite, which JSON does not allow")
        metrics = tuple(zip(names, units_of(names), strict=True))
        records = record_texts(
            values.shape[1],
            [run.caveats for _, run in some],
            some[0][1].timing,
            [_provenance(run.config, batcher) for _, run in some],
            texts,
        )
        for (name, run), record in zip(some, records, strict=True):
            config = run.config
            end = store.RunOutcome(name, "", False, len(run.caveats.caveats), this_machine())
            yield ShardRow(end, texts.of(config.resolved), config.arm.urdf, record, metrics, run.values)


def _provenance(config: RunConfig, batcher: BatchSimulator) -> dict[str, object]:
    """Return the provenance of a run; runs with the same components share most of it."""
    key = ("provenance", config.composed.choices, config.cache_key)
    common = batcher.memory.known(key, lambda: job_provenance(config))
    return {**common, "command": command(config.composed), "seed": config.settings.seed}
