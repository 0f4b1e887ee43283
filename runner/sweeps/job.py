"""Simulation and measurement of the repetitions of one checked config."""

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path

import numpy as np

from runner import store
from runner.base import progress
from runner.base.errors import ConfigError, SimulationError
from runner.base.ticks import counter
from runner.base.trace import Failure, Trace
from runner.config.compose.compose import Composed, compose
from runner.config.limits import check_cpu_time
from runner.config.run import RunConfig
from runner.config.validation import validate
from runner.metrics import Columns, MetricContext, evaluate
from runner.metrics.caveats import PlantStep, Watch, setting_of, signals_of
from runner.metrics.plant_error import COMPARED, PlantError, compare, on_runge_kutta, reason_not_comparable
from runner.sensing import ForceTorqueSensor
from runner.simulation.assembly import assemble, metric_context
from runner.simulation.batch_blocks import simulate_blocks, threads_allowed
from runner.simulation.batch_jobs import NO_DEADLINE, seconds_together, warm_time
from runner.simulation.loop import ClosedLoop, simulate
from runner.simulation.provenance import job_provenance
from runner.simulation.result import RunResult, timing
from runner.simulation.sensors import make_sensors
from runner.store.kinds import note

PROBED_TICKS = 50
"""Number of ticks for a measurement of the time for a tick, if a run is simulated separately."""
_PROBED_TOGETHER = 100_000  # ticks, if repetitions are simulated together
_CLOCKED_TICKS = 1_000_000  # ticks whose time is kept; more would add no information


def simulate_job(config: RunConfig, composed: Composed, threads: int = 1) -> RunResult:
    """Simulate the repetitions of a checked config.

    Args:
        config: The checked config.
        composed: The composed config before its check, for provenance.
        threads: Number of threads that simulate the repetitions of a run that is compiled as a whole.

    Raises:
        ConfigError: if the start of the trajectory cannot be reached, or a component rejects its config.
    """
    together = simulate_blocks((config, composed), threads)
    if together is not None:
        return together
    wall, cpu = time.perf_counter(), time.process_time()
    loop = assemble(config)
    context = metric_context(config)
    watch = Watch(setting_of(config, loop.q_start), config.caveats)
    first: Trace | None = None
    of_first: dict[str, float | None] = {}
    failure: tuple[int, Failure] | None = None
    columns, ticks, laws = Columns(config.settings.repetitions), [], []
    clocked = 0
    messages: list[str] = []
    told: list[str] = []
    try:
        for repetition in range(config.settings.repetitions):
            if repetition > 0 and (config.mismatch.spread > 0.0 or "mismatch" in config.plugged):  # another model
                last, loop = loop, assemble(config, repetition)
                last.close()
            ran, said = _simulate(loop, config, repetition)
            trace, measured = _judge(ran, context, told)
            messages = messages or said
            if first is None:
                first, of_first = trace, measured
            if trace.failure is not None and failure is None:
                failure = (repetition, trace.failure)
            if trace.failure is None:
                watch.look(signals_of(trace, measured))
            columns.put(repetition, measured)
            if clocked < _CLOCKED_TICKS:
                ticks.append(trace.tick_seconds)
                laws += [] if trace.law_seconds is None else [trace.law_seconds]
                clocked += len(trace.tick_seconds)
    finally:
        loop.close()
    assert first is not None  # noqa: S101 - repetitions is at least 1
    seconds = time.perf_counter() - wall, time.process_time() - cpu
    error = _plant_error(config, composed, first, of_first)
    step = PlantStep(config.plant.kind, config.timing.step, config.timing.tick, config.robot.settling_band)
    return RunResult(
        resolved=config.resolved,
        urdf=config.arm.urdf,
        trace=first,
        metrics=columns.summarize(),
        caveats=watch.found(error, step),
        repetitions=config.settings.repetitions,
        failure=failure,
        timing=timing(np.concatenate(ticks), *seconds, np.concatenate(laws) if laws else None),
        provenance=job_provenance(config, composed, [*messages, *dict.fromkeys(told)]),
        plant_error=error,
    )


def seconds_per_tick(
    config: RunConfig,
    composed: Composed,
    within: AbstractContextManager[None] = NO_DEADLINE,
    clock: Callable[[], float] = time.perf_counter,
) -> float:
    """Return the CPU time for a tick of a run, in s, measured on its first ticks.

    Args:
        config: The checked config.
        composed: The composed config before its check.
        within: Context of the measurement, entered after assembly and compilation; it may end the measurement.
        clock: Function that returns the time, in s.
    """
    if config.timing.ticks <= _PROBED_TOGETHER:
        together = seconds_together((config, composed), _PROBED_TOGETHER, within, clock)
        if together is not None:
            return together
    whole = assemble(config)
    part = replace(whole, ticks=min(whole.ticks, PROBED_TICKS))
    try:
        with within:
            return warm_time(lambda: _simulate(part, config, 0), clock) / (part.ticks + 1)
    finally:
        whole.close()


def _plant_error(
    config: RunConfig, composed: Composed, trace: Trace, measured: Mapping[str, float | None]
) -> PlantError | None:
    """Return the integration error in repetition 0; None if it is disabled or the plant cannot be compared."""
    if not config.settings.plant_error or config.plant.kind not in COMPARED:
        return None
    if reason := reason_not_comparable(config.environment.kind):
        return PlantError(None, reason)
    other = replace(composed, resolved=on_runge_kutta(config.resolved))
    try:
        checked = validate(other.resolved, other.config_dirs)
        made = simulate_job(checked, other)
    except ConfigError as error:
        return PlantError(None, str(error))
    others = {name: summary.median for name, summary in made.metrics.items()}
    return compare(trace, measured, made.trace, others, config.robot.settling_band, checked.timing.step)


def _judge(trace: Trace, context: MetricContext, told: list[str]) -> tuple[Trace, dict[str, float | None]]:
    """Return a trace and its metrics; if a plug-in makes these fail, return the trace with that failure."""
    try:
        return trace, evaluate(trace, context, told)
    except SimulationError as error:
        return replace(trace, failure=Failure(error.reason, float(trace.t[-1]))), {}


def _simulate(closed: ClosedLoop, config: RunConfig, repetition: int) -> tuple[Trace, list[str]]:
    """Simulate a repetition; return its trace, and the messages of the controllers and of the wrist sensor."""
    made = make_sensors(closed, config, repetition)
    trace, wrist = simulate(closed, *made), made[1]
    users = [loop.wrench_feedback for loop in closed.loops if loop.wrench_feedback is not None]
    told = [message for controller in users for message in controller.messages()]
    return trace, told + (wrist.overloads() if isinstance(wrist, ForceTorqueSensor) else [])


_SURELY_ALLOWED = 200_000  # ticks, which take minutes at most


def run(*overrides: str, config_dirs: Sequence[Path] = ()) -> store.Run:
    """Run `runner OVERRIDES` from Python.

    Args:
        overrides: Hydra overrides, such as "robot=macro" and "trajectory=goal".
        config_dirs: User config folders, searched before the built-in ones.

    Returns:
        The stored run, with `.metrics`, `.trace` and `.folder`; an existing run is reused.

    Raises:
        ConfigError: if the config cannot be run; the error lists all its problems.
        StoreError: if the outputs folder cannot be written.
    """
    return execute(compose(overrides, config_dirs))


def execute(composed: Composed) -> store.Run:
    """Run a composed config, or return its stored run; see `run`."""
    return find_or_make(composed, validate(composed.resolved, composed.config_dirs))[0]


def find_or_make(composed: Composed, config: RunConfig) -> tuple[store.Run, bool]:
    """Run a checked config, or find its stored run; return the run, and True if it was simulated now."""
    outputs = Path(config.settings.outputs)
    name = store.run_hash(composed.resolved, config.arm.urdf)
    try:
        stored = store.find_run(outputs, name)
    except store.DamagedError as error:
        print(f"runner: {error}; making it again", file=sys.stderr)
        stored = None
    if stored is not None:
        note(stored.folder)
        return store.judge_run(stored, config.spec.metrics), False
    ticks = config.timing.ticks * config.settings.repetitions
    if ticks > _SURELY_ALLOWED:
        check_cpu_time(config.limits, seconds_per_tick(config, composed) * ticks, 1)
    store.prepare(outputs)
    progress.begin("simulating", ticks, "ticks", counter())
    result = simulate_job(config, composed, threads_allowed())
    progress.begin("storing the run")
    made = store.write_run(outputs, name, result)
    note(made.folder)
    return made, True
