"""CPU time of what is around the ticks of many runs at once: encoder noise, metrics, caveats, records and a shard.

`python -m bench around` takes 256 different Macro runs of 400 ticks and one repetition, like those of a sweep.
"""

import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.base.trace import Trace
from runner.caveats.monitor import Watch, look_together
from runner.caveats.setting import setting_of, signals_of
from runner.config.compose.compose import compose
from runner.metrics.summary import measure
from runner.plugins.metric_units import units_of
from runner.sensing.encoders import encoder_errors
from runner.simulation.loop import simulate
from runner.simulation.provenance import job_provenance
from runner.simulation.results import metric_context, timing
from runner.simulation.sensors import make_encoders
from runner.store import RunOutcome
from runner.store.seal import JsonTexts
from runner.store.shards import ShardRow, shard_name, write_shard
from runner.sweeps.records import record_texts

_RUNS, _TIMES = 256, 30
_OVERRIDES = ("robot=macro", "plant=rk4", "trajectory=quintic", "noise=thesis", "torque_limits=thesis")


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: Number of rounds; None for _TIMES.
    """
    times = rounds or _TIMES
    config = validate(compose(_OVERRIDES))
    loop, context = assemble(config), metric_context(config)
    trace = simulate(loop, make_encoders(loop, config.noise, 0, 0))
    loop.close()
    traces = _varied(trace[None])
    clocked, provenance = timing(np.zeros(1), 0.0, 0.0), job_provenance(config)
    metrics = measure(traces, context)
    setting = setting_of(config, loop.q_start)  # kept for all repetitions of a config, see simulation/batch.py

    def look() -> list[Watch]:
        watches = [Watch(setting, config.caveats) for _ in range(_RUNS)]
        look_together(watches, signals_of(traces, metrics))
        return watches

    found = [watch.found() for watch in look()]

    of_metrics = tuple(zip(metrics, units_of(tuple(metrics)), strict=True))
    values = np.stack(list(metrics.values()), axis=1)

    def store(outputs: Path) -> None:
        texts = JsonTexts()
        own = [{**provenance, "seed": run} for run in range(_RUNS)]
        records = record_texts(1, found, clocked, own, texts)
        rows = [
            ShardRow(
                RunOutcome(f"{run:024x}", "", False, len(found[run].caveats)),
                texts.of({**config.resolved, "seed": run}),
                config.arm.urdf,
                record,
                of_metrics,
                values[run : run + 1],
            )
            for run, record in enumerate(records)
        ]
        write_shard(outputs, shard_name(1, "bench", 1), rows)

    print(f"CPU time a run of {len(trace.t) - 1} ticks, {_RUNS} at once, quickest of {times}")
    with tempfile.TemporaryDirectory() as folder:
        seeds = [[0, run, 0] for run in range(_RUNS)]
        met = [
            _judge("encoder noise", lambda: encoder_errors([config.noise] * _RUNS, seeds, len(trace.t)), 0.02, times),
            _judge("metrics", lambda: measure(traces, context), 0.06, times),
            _judge("caveats", lambda: [watch.found() for watch in look()], 0.03, times),
            _judge("records and shard", lambda: store(Path(folder)), 0.12, times),
        ]
    return all(met)


def _varied(one: Trace) -> Trace:
    """Return many runs like one, each a little different."""
    factor = 1.0 + 1e-3 * np.random.default_rng(0).normal(size=(_RUNS, 1, 1))
    return replace(
        one,
        q=one.q * factor,
        dq=one.dq * factor,
        tau=one.tau * factor,
        end_points=one.end_points * factor,
        limits=np.repeat(one.limits, _RUNS, axis=0),
    )


def _judge(what: str, part: Callable[[], object], target: float, times: int) -> bool:
    found = min(_clocked(part) for _ in range(times)) / _RUNS * 1e3
    print(f"  {what:20} {found:.3f} ms  target {target:g}: {'met' if found <= target else 'MISSED'}")
    return found <= target


def _clocked(part: Callable[[], object]) -> float:
    start = time.process_time()
    part()
    return time.process_time() - start
