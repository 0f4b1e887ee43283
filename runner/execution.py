"""One job: check a composed config, simulate its repetitions, store the result; or find it stored already."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from runner import provenance, store
from runner.assembly import assemble, make_encoders, make_wrist_sensor, metric_context
from runner.config.compose import Composed, compose
from runner.config.run import RunConfig
from runner.config.validation import validate
from runner.metrics import evaluate, summarize
from runner.sensing import ForceTorqueSensor
from runner.simulation import ClosedLoop, simulate
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
    return store.write_run(outputs, name, simulate_job(config, composed))


def simulate_job(config: RunConfig, composed: Composed) -> store.RunResult:
    """Simulate the repetitions of a checked config.

    Args:
        config: The checked config.
        composed: What it was checked from, for provenance.

    Raises:
        ConfigError: where the start of the trajectory cannot be reached, or a part refuses its config.
    """
    wall, cpu = time.perf_counter(), time.process_time()
    loop = assemble(config)
    context = metric_context(config, loop)
    first: Trace | None = None
    failure: tuple[int, Failure] | None = None
    metrics, ticks = [], []
    notices: list[str] = []
    told: list[str] = []
    try:
        for repetition in range(config.settings.repetitions):
            if repetition > 0 and config.mismatch.spread > 0.0:  # other beliefs
                last, loop = loop, assemble(config, repetition)
                last.plant.close()
            encoders, wrist = make_encoders(config, loop, repetition), make_wrist_sensor(config, loop, repetition)
            trace = simulate(loop, encoders, wrist)
            notices = notices or _notices(loop, wrist)
            first = trace if first is None else first
            if trace.failure is not None and failure is None:
                failure = (repetition, trace.failure)
            metrics.append(evaluate(trace, context, told))
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
        provenance=job_provenance(config, composed, [*notices, *dict.fromkeys(told)]),
    )


def _notices(closed: ClosedLoop, wrist: ForceTorqueSensor | None) -> list[str]:
    """Return what the controllers and the sensor tell of the repetition just run."""
    feeling: Any = [loop.controller for loop in closed.loops if loop.feels]
    told = [notice for controller in feeling for notice in controller.notices()]
    return told + ([] if wrist is None else wrist.overloads())


def job_provenance(config: RunConfig, composed: Composed, notices: Sequence[str] = ()) -> dict[str, object]:
    """Return where a run comes from: what made it, choices, time steps, seed, warnings."""
    return {
        **provenance.made(composed),
        "choices": dict(composed.choices),
        "plant_step": config.step,
        "steps_per_tick": config.steps_per_tick,
        "tip_frame": config.arm.model.tip_name,
        "stages": {stage.name: stage.base_frame for stage in config.arm.stages},
        "joints": list(config.arm.model.joint_names),
        "seed": config.settings.seed,
        "warnings": [*config.warnings, *notices],
    }
