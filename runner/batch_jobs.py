"""Runs that are simulated together, from their checked configs to what is stored of each."""

from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass

import numpy as np

from runner import store
from runner.batch import Batcher, Wanted
from runner.caveats import Found, Setting, Watch, look_together, setting_of, signals_of
from runner.config.compose import Composed
from runner.config.run import RunConfig
from runner.metrics import measure, summarize_arrays
from runner.provenance import job_provenance
from runner.store.writing import timing
from runner.trace import Failure, FloatArray, Trace

Job = tuple[RunConfig, Composed]


@dataclass(frozen=True)
class Simulated:
    """A run all of whose repetitions are simulated.

    Attributes:
        place: Which it is of those that were asked for.
        job: Its checked config, and what that was checked from.
        names: Names of its metrics; empty where no repetition ended well.
        values: Its metrics, shape (repetitions, metrics), NaN for none.
        caveats: Why they may not be what they seem.
        failure: The first failure and its repetition, or None.
        trace: The trace of repetition 0.
        seconds: Its share of the time that a clock measured, in s.
    """

    place: int
    job: Job
    names: tuple[str, ...]
    values: FloatArray
    caveats: Found
    failure: tuple[int, Failure] | None
    trace: Trace
    seconds: float

    @property
    def timing(self) -> dict[str, float | None]:
        """What a clock measured."""
        return timing(self.trace.tick_seconds, self.seconds, self.seconds)

    def result(self) -> store.RunResult:
        """Return all that it leaves to be stored."""
        config, composed = self.job
        return store.RunResult(
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


class _Gathered:
    """What is known so far of a run."""

    def __init__(self, place: int, job: Job, runs: Sequence[Wanted], batcher: Batcher) -> None:
        self._place, self._job = place, job
        self.watch = Watch(_setting(job[0], runs[0].q_start, batcher), job[0].caveats)
        self._names: tuple[str, ...] = ()
        self._values = np.zeros((len(runs), 0))
        self._failure: tuple[int, Failure] | None = None
        self._trace: Trace | None = None
        self._left, self._seconds = len(runs), 0.0

    def measured(self, repetition: int, names: tuple[str, ...], values: FloatArray) -> None:
        """Take the metrics of a repetition that ended well."""
        if not self._names:
            self._names, self._values = names, np.full((len(self._values), len(names)), np.nan)
        self._values[repetition] = values

    def failed(self, repetition: int, failure: Failure) -> None:
        """Take note of a repetition that failed."""
        if self._failure is None or repetition < self._failure[0]:
            self._failure = repetition, failure

    def ended(self, seconds: float, trace: Trace | None) -> Simulated | None:
        """Take note that a repetition has ended, with the trace of the first; return the run once all have."""
        self._left -= 1
        self._seconds += seconds
        self._trace = self._trace if trace is None else trace
        if self._left or self._trace is None:
            return None
        found = self.watch.found()
        return Simulated(
            self._place, self._job, self._names, self._values, found, self._failure, self._trace, self._seconds
        )


def _setting(config: RunConfig, q_start: FloatArray, batcher: Batcher) -> Setting:
    """Return the setting of a run, which those that differ in nothing but the seed share."""
    parts = (
        *("setting", config.arm, config.loops, config.plant, config.controller, config.noise, config.torque_limits),
        *(q_start, config.path, config.mismatch, config.robot, config.environment, config.wrist_sensor),
        *(*astuple(config.timing), config.commands, config.settings.repetitions),
    )
    return batcher.memory.known(parts, lambda: setting_of(config, q_start))


def simulate_together(
    jobs: Sequence[Job], runs: Sequence[Sequence[Wanted]], batcher: Batcher
) -> Iterator[list[Simulated]]:
    """Simulate runs; yield those that are complete, some at a time.

    Args:
        jobs: The runs.
        runs: All repetitions of each.
        batcher: Simulates them.

    Raises:
        SimulationError: where a trajectory of the user's goes wrong in a metric.
    """
    gathered = [_Gathered(place, job, own, batcher) for place, (job, own) in enumerate(zip(jobs, runs, strict=True))]
    owners = [(own, run.repetition) for own, of_job in zip(gathered, runs, strict=True) for run in of_job]
    for found in batcher.simulate([run for of_job in runs for run in of_job]):
        ended = []
        if isinstance(found, tuple):
            (own, repetition), trace = owners[found[0]], found[1]
            assert trace.failure is not None  # noqa: S101 - such a trace has one
            own.failed(repetition, trace.failure)
            ended.append(own.ended(trace.tick_seconds.sum(), None if repetition else trace))
        else:
            metrics = measure(found.traces, found.context)
            names, values = tuple(metrics), np.stack(list(metrics.values()), axis=1)
            them = [owners[place] for place in found.places]
            look_together([own.watch for own, _ in them], signals_of(found.traces, metrics))
            seconds = float(found.traces.tick_seconds.sum())
            for row, (own, repetition) in enumerate(them):
                own.measured(repetition, names, values[row])
                ended.append(own.ended(seconds, None if repetition else found.traces.run(row)))
        complete = [run for run in ended if run is not None]
        if complete:
            yield complete
