"""Batch simulation of several runs, from their checked configs to the results to store."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.trace import Failure, Trace
from runner.config.compose.compose import Composed
from runner.config.run import RunConfig
from runner.metrics import measure, summarize_arrays
from runner.metrics.caveats import Found, Watch, look_together, setting_of, signals_of
from runner.simulation.batch import BatchSimulator, RunSpec
from runner.simulation.provenance import job_provenance
from runner.simulation.result import RunResult, timing

Job = tuple[RunConfig, Composed]
NO_DEADLINE: AbstractContextManager[None] = nullcontext()
_LONG = 0.5  # s: what takes longer is not made twice to be timed


@dataclass(eq=False)
class Simulated:
    """A run and the results of its repetitions, or of those that were asked for; complete once `left` is 0.

    Attributes:
        place: Which it is of those that were asked for.
        job: Its checked config, and what that was checked from.
        first: Number of the first repetition that was asked for.
        watch: Looks for caveats.
        left: Number of repetitions that are not simulated yet.
        values: Its metrics, shape (repetitions, metrics), NaN for none.
        names: Names of its metrics; empty where no repetition ended well.
        failure: The first failure and its repetition, or None.
        trace: The trace of the first repetition; None until that is simulated.
        seconds: Its part of the time that a clock measured, in s.
    """

    place: int
    job: Job
    first: int
    watch: Watch
    left: int
    values: FloatArray
    names: tuple[str, ...] = ()
    failure: tuple[int, Failure] | None = None
    trace: Trace | None = None
    seconds: float = 0.0

    @classmethod
    def begin(cls, place: int, job: Job, runs: Sequence[RunSpec], batcher: BatchSimulator) -> "Simulated":
        """Return a run with no result yet; see simulate_together."""
        config, q_start = job[0], runs[0].q_start
        setting = batcher.memory.known(("setting", q_start, *config.cache_key), lambda: setting_of(config, q_start))
        watch = Watch(setting, config.caveats)
        return cls(place, job, runs[0].repetition, watch, len(runs), np.zeros((len(runs), 0)))

    def measured(self, repetitions: Sequence[int], names: tuple[str, ...], values: FloatArray) -> None:
        """Take the metrics of repetitions that ended well, shape (n, metrics)."""
        if not self.names:
            self.names, self.values = names, np.full((len(self.values), len(names)), np.nan)
        self.values[np.array(repetitions) - self.first] = values

    def failed(self, repetition: int, failure: Failure) -> None:
        """Take the failure of a repetition."""
        if self.failure is None or repetition < self.failure[0]:
            self.failure = repetition, failure

    def ended(self, repetitions: int, seconds: float, trace: Trace | None) -> bool:
        """Note that repetitions have ended, and return whether all have.

        Args:
            repetitions: Number of them.
            seconds: The time that each took, in s.
            trace: The trace of `first` if it is among them.
        """
        self.left -= repetitions
        self.seconds += seconds * repetitions
        self.trace = self.trace if trace is None else trace
        return not self.left

    @cached_property
    def caveats(self) -> Found:
        """Why they may not be what they seem."""
        return self.watch.found()

    @property
    def timing(self) -> dict[str, float | None]:
        """What a clock measured."""
        assert self.trace is not None  # noqa: S101 - it is complete
        return timing(self.trace.tick_seconds, self.seconds, self.seconds)

    def result(self) -> RunResult:
        """Return all that it leaves to be stored."""
        config, composed = self.job
        assert self.trace is not None  # noqa: S101 - it is complete
        return RunResult(
            resolved=config.resolved,
            urdf=config.arm.urdf,
            trace=self.trace,
            metrics=summarize_arrays(self.names, self.values),
            caveats=self.caveats,
            repetitions=config.settings.repetitions,
            failure=self.failure,
            timing=self.timing,
            provenance=job_provenance(config, composed),
        )


def seconds_together(
    job: Job,
    ticks: int,
    within: AbstractContextManager[None] = NO_DEADLINE,
    clock: Callable[[], float] = time.perf_counter,
) -> float | None:
    """Return the time for a tick of a run in company, in s; None where it cannot be simulated together with others.

    Args:
        job: The run.
        ticks: Ticks that are made for it, about, and once more if that is quick.
        within: Entered once all is assembled and compiled; may end the measurement.
        clock: Tells the time, in s.
    """
    config, batcher = job[0], BatchSimulator()
    repetitions = range(min(config.settings.repetitions, max(1, ticks // config.timing.ticks)))
    runs = batcher.repetitions(config, repetitions)
    if runs is None:
        return None
    copies = max(1, ticks // (len(runs) * config.timing.ticks))

    def make() -> None:
        for _ in simulate_together([job] * copies, [runs] * copies, batcher):
            pass

    with within:
        return warm_time(make, clock) / (copies * len(runs) * config.timing.ticks)


def warm_time(make: Callable[[], object], clock: Callable[[], float]) -> float:
    """Return the time that something takes, in s: of the second time, if the first does not already take long."""
    took = 0.0
    for _ in range(2):
        if took < _LONG:
            start = clock()
            make()
            took = clock() - start
    return took


def simulate_together(
    jobs: Sequence[Job], runs: Sequence[Sequence[RunSpec]], batcher: BatchSimulator
) -> Iterator[list[Simulated]]:
    """Simulate runs; yield those that are complete, some at a time.

    Args:
        jobs: The runs.
        runs: All repetitions of each, or some that follow on each other.
        batcher: Simulates them.

    Raises:
        SimulationError: where a trajectory of the user's goes wrong in a metric.
    """
    owners = []
    for place, (job, own_runs) in enumerate(zip(jobs, runs, strict=True)):
        own = Simulated.begin(place, job, own_runs, batcher)
        owners += [(own, run.repetition) for run in own_runs]
    for found in batcher.simulate([run for of_job in runs for run in of_job]):
        complete = []
        if isinstance(found, tuple):
            (own, repetition), trace = owners[found[0]], found[1]
            assert trace.failure is not None  # noqa: S101 - such a trace has one
            own.failed(repetition, trace.failure)
            if own.ended(1, trace.tick_seconds.sum(), trace if repetition == own.first else None):
                complete.append(own)
        else:
            metrics, traces = measure(found.traces, found.context), found.traces
            names, values = tuple(metrics), np.stack(list(metrics.values()), axis=1)
            them = [owners[place] for place in found.places]
            apart = [(own, [repetition for _, repetition in group]) for own, group in groupby(them, lambda it: it[0])]
            watches = [own.watch for own, _ in (them if len(apart) > 1 else apart)]
            look_together(watches, signals_of(traces, metrics))
            seconds, row = float(traces.tick_seconds.sum()), 0
            for own, repetitions in apart:
                own.measured(repetitions, names, values[row : row + len(repetitions)])
                first = traces.run(row) if own.first == repetitions[0] else None
                if own.ended(len(repetitions), seconds, first):
                    complete.append(own)
                row += len(repetitions)
        if complete:
            yield complete
