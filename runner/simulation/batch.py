"""Batch simulation of compiled runs: repetitions of one run, or runs that differ only in numbers.

Each run has the same result as in a separate simulation, to the last bit.
"""

import math
import time
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from threading import Lock
from typing import Self

import numpy as np
from numpy.typing import NDArray

from runner.assembly.assemble import assemble_program
from runner.assembly.compiled.loop_program import LoopProgram, run_all
from runner.assembly.compiled.loops import Rows
from runner.assembly.drawn_loops import draw_commands, draws_together
from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.memory import Memory
from runner.base.ticks import add_ticks
from runner.base.trace import Failure, Trace
from runner.caveats.monitor import Watch, look_together
from runner.caveats.setting import setting_of, signals_of
from runner.config.parsing import require
from runner.metrics.family import MetricContext
from runner.metrics.summary import measure
from runner.plugins.discovery import added_parts
from runner.robots.model import RobotModel
from runner.sensing.encoders import encoder_errors
from runner.simulation.by_ticks import simulate_by_ticks
from runner.simulation.recorder import DIVERGED_SPEED, describe, failure_of, find_divergence
from runner.simulation.results import Collector, metric_context, reach_of

_MOST_BYTES = 32e6  # limit of the signals of runs that are simulated together
_GROWTH = math.log(1.25)  # limit of the longest over the shortest run in a batch
_MOST_KEPT = 2000
_ONE_AT_A_TIME = Lock()  # PyBullet's servers belong to the process
_MEMORY = Memory(4096)  # for controllers


@dataclass(frozen=True)
class RunSpec:
    """A repetition of a run.

    Attributes:
        config: The run's checked config.
        repetition: Number of the repetition.
        loop_program: The closed loop.
        q_start: Initial joint positions, shape (nq,), in rad.
    """

    config: RunConfig
    repetition: int
    loop_program: LoopProgram
    q_start: FloatArray

    def first(self, ticks: int) -> Self:
        """Return the run up to a number of ticks."""
        return (
            self
            if ticks >= self.config.timing.ticks
            else replace(self, config=replace(self.config, timing=replace(self.config.timing, ticks=ticks)))
        )

    @property
    def rows(self) -> int:
        """Number of rows of the trace."""
        return self.config.timing.ticks + 1

    @property
    def code(self) -> Hashable:
        """Key of the runs that are simulated together."""
        loop_program = self.loop_program
        every = tuple(loop.every for loop in loop_program.commands.loops)
        return (
            loop_program.pattern,
            every,
            loop_program.delay,
            loop_program.steps,
            loop_program.tick,
            int(math.log(self.rows) / _GROWTH),
        )

    @property
    def inputs(self) -> Hashable:
        """Key of the runs whose parameters and start are determined together."""
        return id(self.config if draws_together(self.config) else self.loop_program)

    @property
    def scene(self) -> Hashable:
        """Key of the runs that are measured together."""
        config = self.config
        reach = _MEMORY.recall(reach_of, config.controller)
        return id(config.arm), id(config.path), self.rows, config.robot.settling_band, reach


@dataclass(frozen=True)
class BatchResult:
    """Runs that succeeded and are measured together.

    Attributes:
        places: Indices among the requested runs.
        traces: Trace of the runs.
        context: Data for the metrics.
    """

    places: Sequence[int]
    traces: Trace
    context: MetricContext


class BatchSimulator:
    """Simulator of runs in batches; it keeps shared results as long as configs share the same objects."""

    def __init__(self) -> None:
        self.memory = Memory(_MOST_KEPT)
        """Results that follow from shared components."""

    def repetitions(self, config: RunConfig, chosen: range | None = None) -> list[RunSpec] | None:
        """Return the repetitions of a run for batch simulation; None if they cannot be simulated in a batch.

        Args:
            config: The run's checked config.
            chosen: Numbers of the repetitions; None for all.

        Raises:
            ConfigError: see assemble.
        """
        if not config.compilable:
            return None
        numbers = range(config.settings.repetitions) if chosen is None else chosen
        if not config.varies_model or draws_together(config):
            alike = self._loop(config, numbers[0])
            return None if alike is None else [RunSpec(config, number, *alike) for number in numbers]
        found = []
        for number in numbers:
            own = self._loop(config, number)
            if own is None:
                return None
            found.append(RunSpec(config, number, *own))
        return found

    def _loop(self, config: RunConfig, repetition: int) -> tuple[LoopProgram, FloatArray] | None:
        """Return the closed loop of a repetition and its start; see assemble_program.

        If nominal models are drawn together, the code is that of repetition 0.
        """
        repetition = 0 if draws_together(config) else repetition
        drawn = (config.settings.seed, repetition) if config.varies_model else ()
        return self.memory.known(("loop", *drawn, config.cache_key), lambda: assemble_program(config, repetition))

    def simulate(self, runs: Sequence[RunSpec]) -> Iterator[BatchResult | tuple[int, Trace]]:
        """Simulate runs; yield successful runs in batches, and the index and trace of each failed run."""
        for places in _grouped(range(len(runs)), lambda place: runs[place].code):
            first = runs[places[0]]
            signals = 4 * len(first.q_start) + 3 * len(first.config.arm.stages) + 1
            most = max(1, int(_MOST_BYTES / (8 * signals * first.rows)))
            for begin in range(0, len(places), most):
                part = places[begin : begin + most]
                ticks = sum(runs[place].config.timing.ticks for place in part)
                for found in self._simulate([runs[place] for place in part]):
                    if isinstance(found, BatchResult):
                        yield replace(found, places=[part[index] for index in found.places])
                    else:
                        yield part[found[0]], found[1]
                add_ticks(ticks)

    def _simulate(self, runs: Sequence[RunSpec]) -> Iterator[BatchResult | tuple[int, Trace]]:
        """Simulate runs with the same code; indices refer to this sequence."""
        rows, loop_program = max(run.rows for run in runs), runs[0].loop_program
        times = np.arange(rows, dtype=np.float64) * loop_program.tick
        paths = [self._desired(run, times) for run in runs]
        alike = all(path is paths[0] for path in paths)
        errors = draw_errors(runs, rows)
        values, start = _inputs(runs, [wrong[:, 0] for wrong in errors])
        shared = self._shared(runs if not alike else runs[:1], times, paths)
        loop_program.code_for(len(runs))  # loaded before the clock starts
        began = time.perf_counter()
        found = run_all(loop_program, values, shared, errors, start)
        seconds, well = (time.perf_counter() - began) / (len(runs) * rows), _ended_well(found)
        for place in np.flatnonzero(found.stopped).tolist():
            yield _by_ticks(runs[place], place)
        whole = np.flatnonzero(~found.stopped).tolist()
        for places in _grouped(whole, lambda place: runs[place].scene):
            one = runs[places[0]]
            traces = self._traces(found, runs, places, paths[places[0]], times, seconds)
            good = []
            for index, place in enumerate(places):
                failure = None
                if not well[place]:
                    failure = _find_failure(loop_program, found, place, traces.t, one.config.arm.model)
                if failure is None:
                    good.append(index)
                else:
                    yield place, traces[index].ended(failure)
            if good:
                kept = traces if len(good) == len(places) else traces[good]
                yield BatchResult([places[index] for index in good], kept, metric_context(one.config))

    def _shared(self, runs: Sequence[RunSpec], times: FloatArray, paths: Sequence[FloatArray]) -> FloatArray:
        """Return time and path at each tick, of one run if all are the same, else of each."""
        commands, one = runs[0].loop_program.commands, len(runs) == 1
        joints = [run.config.path.sample_joints(times) for run in runs] if commands.follow_joints else []
        return commands.shared(
            times, paths[0] if one else np.array(paths), (joints[0] if one else np.array(joints)) if joints else None
        )

    def _desired(self, run: RunSpec, times: FloatArray) -> FloatArray:
        path = run.config.path
        return self.memory.known(("desired", path, len(times), run.loop_program.tick), lambda: path.sample(times))

    def _traces(
        self,
        rows: Rows,
        runs: Sequence[RunSpec],
        places: Sequence[int],
        desired: FloatArray,
        times: FloatArray,
        seconds: float,
    ) -> Trace:
        one = runs[places[0]]
        config, own = one.config, slice(None) if len(places) == len(runs) else list(places)
        t = times[: one.rows]
        acted = np.maximum(np.arange(len(t)) - one.loop_program.delay, 0) if one.loop_program.delay else slice(len(t))
        return Trace(
            t=t,
            q=rows.q[own, : len(t)],
            dq=rows.dq[own, : len(t)],
            tau=rows.command[own][:, acted],
            end_points=rows.end_points[:, own, : len(t)],
            desired=desired[: len(t)],
            limits=np.array([_limits(runs[place], rows.command[place], rows.dq[place], acted) for place in places]),
            tick_seconds=np.full(len(t) - 1, seconds),
            **self.memory.recall(describe, config.arm, config.ignore_base_rotation),
        )


def _by_ticks(run: RunSpec, place: int) -> BatchResult | tuple[int, Trace]:
    """Return a run at a place, simulated tick by tick."""
    with _ONE_AT_A_TIME:
        trace = simulate_by_ticks(run.config, run.repetition, run.config.timing.ticks, lambda _: run.q_start)
    if trace.failure is not None:
        return place, trace
    return BatchResult([place], replace(trace, law_seconds=None)[None], metric_context(run.config))


def _limits(run: RunSpec, command: FloatArray, dq: FloatArray, acted: NDArray[np.intp] | slice) -> FloatArray:
    """Return the limits of the acting torques of a run; see Trace.limits."""
    commands = run.loop_program.commands
    held = [(loop.joints, loop.every) for loop in commands.loops]
    limits = commands.limits.applied(command, dq, held)
    return limits[acted] if commands.limits.depend_on_speed else limits


def _inputs(runs: Sequence[RunSpec], errors: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return parameters and initial state of each run; see LoopProgram.values and Commands.start.

    Nominal models that are drawn together are drawn here.
    """
    inputs: dict[int, tuple[FloatArray, FloatArray]] = {}
    for own in _grouped(range(len(runs)), lambda place: runs[place].inputs):
        loop_program, config = runs[own[0]].loop_program, runs[own[0]].config
        commands, values = (
            loop_program.commands,
            np.broadcast_to(loop_program.values, (len(own), len(loop_program.values))),
        )
        if draws_together(config):
            commands = draw_commands(config, [runs[place].repetition for place in own])
            values = loop_program.drawn_values(commands)
        start = commands.start(np.array([runs[place].q_start for place in own]), [wrong[own] for wrong in errors])
        inputs |= dict(zip(own, zip(values, start, strict=True), strict=True))
    all_values, starts = zip(*(inputs[place] for place in range(len(runs))), strict=True)
    return np.array(all_values), np.array(starts)


def draw_errors(runs: Sequence[RunSpec], rows: int) -> list[FloatArray]:
    """Return the errors of the positions that each loop measures, shapes (runs, n, nq), in rad.

    Args:
        runs: Runs with the same code.
        rows: Number of rows of the longest run.
    """
    return [
        encoder_errors(
            [require(run.config.encoder_noise) for run in runs],
            [(run.config.settings.seed, run.repetition, number) for run in runs],
            (rows - 1) // loop.every + 1,
        )
        for number, loop in enumerate(runs[0].loop_program.commands.loops)
    ]


def _ended_well(rows: Rows) -> NDArray[np.bool_]:
    """Return True for each run compiled as a whole that ended without a failure, shape (runs,)."""
    finite = np.isfinite(rows.q).all(axis=(1, 2)) & np.isfinite(rows.command).all(axis=(1, 2))
    slow = np.abs(rows.dq).max(axis=(1, 2)) < DIVERGED_SPEED
    well: NDArray[np.bool_] = finite & slow & ~rows.fault.any(axis=1)
    return well


def _find_failure(
    loop_program: LoopProgram, rows: Rows, run: int, times: FloatArray, model: RobotModel
) -> Failure | None:
    """Return the failure of one of several runs compiled as a whole; None without a failure.

    Args:
        loop_program: The closed loop of one of the runs.
        rows: Signals of the runs.
        run: Index of the run.
        times: Time of each row of the run, shape (T,), in s; it may have fewer rows than the signals.
        model: Model of the arm.
    """
    fault = loop_program.first_fault(rows, run, times)
    last = len(times) if fault is None else fault[0] + 1
    diverged = find_divergence(rows.q[run, :last], rows.dq[run, :last], times[:last], model)
    return diverged if diverged is not None or fault is None else failure_of(fault[1], float(times[fault[0]]))


def _grouped(places: Sequence[int], key: Callable[[int], Hashable]) -> list[list[int]]:
    groups: dict[Hashable, list[int]] = {}
    for place in places:
        groups.setdefault(key(place), []).append(place)
    return list(groups.values())


def simulate_together(runs: Sequence[Sequence[RunSpec]], batcher: BatchSimulator) -> Iterator[list[Collector]]:
    """Simulate several runs; yield the results of complete runs in groups.

    Args:
        runs: Repetitions of each run, in order.
        batcher: The simulator.

    Raises:
        SimulationError: if a user-supplied trajectory fails in a metric.
    """
    owners = []
    for place, of_run in enumerate(runs):
        collector = _collector(place, of_run, batcher)
        owners += [(collector, run.repetition) for run in of_run]
    for found in batcher.simulate([run for of_run in runs for run in of_run]):
        if isinstance(found, BatchResult):
            complete = _collect(found, [owners[place] for place in found.places])
        else:
            collector, repetition = owners[found[0]]
            complete = [collector] if collector.add(repetition, found[1], {}) else []
        if complete:
            yield complete


def _collector(place: int, runs: Sequence[RunSpec], batcher: BatchSimulator) -> Collector:
    config, q_start = runs[0].config, runs[0].q_start
    setting = batcher.memory.known(("setting", q_start, config.cache_key), lambda: setting_of(config, q_start))
    watch = Watch(setting, config.caveats)
    return Collector(config, watch, len(runs), np.zeros((len(runs), 0)), place, runs[0].repetition)


def _collect(found: BatchResult, owners: Sequence[tuple[Collector, int]]) -> list[Collector]:
    """Measure successful repetitions, given the collector and number of each; return complete collectors."""
    traces, complete = found.traces, []
    if added_parts("metric"):  # these take one trace at a time
        pairs = zip(owners, (traces[row] for row in range(len(owners))), strict=True)
        return [owner for (owner, number), trace in pairs if owner.evaluate(number, trace, found.context)]
    metrics = measure(traces, found.context)
    names, values = tuple(metrics), np.stack(list(metrics.values()), axis=1)
    parts = [(owner, [repetition for _, repetition in group]) for owner, group in groupby(owners, lambda it: it[0])]
    watches = [owner.watch for owner, _ in (owners if len(parts) > 1 else parts)]
    look_together(watches, signals_of(traces, metrics))
    seconds, row = float(traces.tick_seconds.sum()), 0
    for owner, repetitions in parts:
        owner.put(repetitions, names, values[row : row + len(repetitions)])
        first = traces[row] if owner.first == repetitions[0] else None
        if owner.end(len(repetitions), seconds, first):
            complete.append(owner)
        row += len(repetitions)
    return complete
