"""One job: check a composed config, simulate its repetitions, store the result; or find it stored already."""

import shlex
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from runner import provenance, store
from runner.assembly import assemble, make_encoders, metric_context
from runner.config.compose import Composed, compose
from runner.config.run import RunConfig
from runner.config.validation import validate
from runner.metrics import evaluate, summarize
from runner.simulation import simulate
from runner.store.writing import timing
from runner.trace import Failure, Trace


def run(*overrides: str, config_dirs: Sequence[Path] = ()) -> store.Run:
    """Do what `runner OVERRIDES` does, from Python.

    Args:
        overrides: Hydra overrides, such as "robot=macro" and "trajectory=goal".
        config_dirs: Config folders of the user's, searched before ours.

    Returns:
        The stored run, with `.metrics`, `.trace` and `.folder`; found stored, it is not simulated again.

    Raises:
        ConfigError: for a config that cannot be run; lists all its problems.
        StoreError: if the outputs folder cannot be written.
    """
    return execute(compose(overrides, config_dirs))


def execute(composed: Composed) -> store.Run:
    """Run a composed config, or return its stored run; see `run`."""
    config = validate(composed.resolved, composed.config_dirs)
    outputs = Path(config.settings.outputs)
    name = store.run_hash(composed.resolved, config.arm.urdf)
    stored = store.find_run(outputs, name)
    if stored is not None:
        return stored
    store.prepare(outputs)
    return store.write_run(outputs, name, _simulate_job(config, composed))


def _simulate_job(config: RunConfig, composed: Composed) -> store.RunResult:
    wall, cpu = time.perf_counter(), time.process_time()
    loop = assemble(config)
    context = metric_context(config, loop)
    first: Trace | None = None
    failure: tuple[int, Failure] | None = None
    metrics, ticks = [], []
    try:
        for repetition in range(config.settings.repetitions):
            trace = simulate(loop, make_encoders(config, loop, repetition))
            first = trace if first is None else first
            if trace.failure is not None and failure is None:
                failure = (repetition, trace.failure)
            metrics.append(evaluate(trace, context))
            ticks.append(trace.tick_seconds)
    finally:
        loop.plant.close()
    assert first is not None  # noqa: S101 - repetitions is at least 1
    return store.RunResult(
        resolved=config.resolved,
        urdf=config.arm.urdf,
        trace=first,
        metrics=summarize(metrics),
        repetitions=config.settings.repetitions,
        failure=failure,
        timing=timing(np.concatenate(ticks), time.perf_counter() - wall, time.process_time() - cpu),
        provenance=_provenance(config, composed),
    )


def _provenance(config: RunConfig, composed: Composed) -> dict[str, object]:
    return {
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "command": shlex.join(["runner", *(o for o in composed.overrides if not o.startswith("outputs="))]),
        "choices": dict(composed.choices),
        "plant_step": config.step,
        "steps_per_tick": config.steps_per_tick,
        "tip_frame": config.arm.model.tip_name,
        "stages": {stage.name: stage.base_frame for stage in config.arm.stages},
        "joints": list(config.arm.model.joint_names),
        "seed": config.settings.seed,
        "commit": provenance.commit(),
        "versions": provenance.versions(),
        "machine": provenance.machine(),
    }
