"""Results of a run, collected as its repetitions end."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.base.trace import Failure, Trace
from runner.caveats.integration_error import PlantError
from runner.caveats.monitor import Watch
from runner.caveats.plant_error import PlantStep
from runner.caveats.rounding_growth import RoundingGrowth
from runner.caveats.rule import Found
from runner.caveats.setting import signals_of
from runner.controllers import ControllerConfig, FollowsWithinReach
from runner.metrics.family import MetricContext
from runner.metrics.summary import Summary, evaluate, summarize_arrays
from runner.simulation.provenance import job_provenance

_CLOCKED_TICKS = 1_000_000  # limit of the ticks whose time is stored


@dataclass(frozen=True)
class RunResult:
    """Result of a run, before it is stored.

    Attributes:
        config: The checked config.
        trace: Trace of repetition 0.
        metrics: Metrics over the repetitions.
        caveats: Caveats of the metrics.
        failure: The first failure and its repetition; None if all repetitions succeeded.
        timing: Measured times.
        provenance: Commit, versions, machine, seed, command.
        plant_error: Integration error; None if it was not asked for or cannot be measured.
        rounding: Growth of rounding errors; None if it was not asked for.
    """

    config: RunConfig
    trace: Trace
    metrics: Mapping[str, Summary]
    caveats: Found
    failure: tuple[int, Failure] | None
    timing: Mapping[str, float | None]
    provenance: Mapping[str, Any]
    plant_error: PlantError | None = None
    rounding: RoundingGrowth | None = None


@dataclass(eq=False)
class Collector:
    """Results of consecutive repetitions of a run, collected as they end; complete when all have ended.

    Attributes:
        config: The checked config.
        watch: Monitor of the caveat rules.
        left: Number of repetitions that have not ended.
        values: Metrics, shape (repetitions, metrics); NaN for no value.
        place: Index of the run among those that are simulated together.
        first: Number of the first repetition.
        names: Names of the metrics; empty if no repetition has succeeded.
        failure: The first failure and its repetition; None if there is none.
        trace: Trace of the first repetition; None until that has ended.
        seconds: Wall-clock time of the repetitions that have ended, in s.
        clocked: Number of ticks whose time is stored.
        tick_seconds: Wall-clock time of each tick of some repetitions, in s.
        law_seconds: Wall-clock time of the control loops in each of these ticks, in s; empty if it was not measured.
        notices: Messages about faults in user-supplied metrics.
    """

    config: RunConfig
    watch: Watch
    left: int
    values: FloatArray
    place: int = 0
    first: int = 0
    names: tuple[str, ...] = ()
    failure: tuple[int, Failure] | None = None
    trace: Trace | None = None
    seconds: float = 0.0
    clocked: int = 0
    tick_seconds: list[FloatArray] = field(default_factory=list)
    law_seconds: list[FloatArray] = field(default_factory=list)
    notices: list[str] = field(default_factory=list)

    def evaluate(self, repetition: int, trace: Trace, context: MetricContext) -> bool:
        """Measure and add a repetition; return True if all have ended."""
        return self.add(repetition, *measure_repetition(trace, context, self.notices))

    def add(self, repetition: int, trace: Trace, metrics: Mapping[str, float | None]) -> bool:
        """Add a repetition that was simulated separately; return True if all have ended."""
        if trace.failure is not None:
            self.fail(repetition, trace.failure)
        else:
            self.watch.look(signals_of(trace, metrics))
            self.put([repetition], tuple(metrics), np.array([list(metrics.values())], dtype=np.float64))
        if repetition != self.first:
            self._clock(trace)
        return self.end(1, float(trace.tick_seconds.sum()), trace if repetition == self.first else None)

    def put(self, repetitions: Sequence[int], names: tuple[str, ...], values: FloatArray) -> None:
        """Add the metrics of successful repetitions, shape (n, metrics); later ones may contain more metrics."""
        rows = np.array(repetitions, dtype=np.intp) - self.first
        if not self.names:
            self.names, self.values = names, np.full((len(self.values), len(names)), np.nan)
        elif names != self.names:
            new = tuple(name for name in names if name not in self.names)
            self.names += new
            self.values = np.hstack([self.values, np.full((len(self.values), len(new)), np.nan)])
        if names == self.names:
            self.values[rows] = values
        else:
            self.values[np.ix_(rows, np.array([self.names.index(name) for name in names]))] = values

    def fail(self, repetition: int, failure: Failure) -> None:
        """Add the failure of a repetition."""
        if self.failure is None or repetition < self.failure[0]:
            self.failure = repetition, failure

    def end(self, repetitions: int, seconds: float, first: Trace | None) -> bool:
        """Count ended repetitions; return True if all have ended.

        Args:
            repetitions: Number of repetitions.
            seconds: Wall-clock time of each, in s.
            first: Trace of the first repetition of the run, if it is among them.
        """
        self.left -= repetitions
        self.seconds += seconds * repetitions
        if first is not None:
            self.trace = first
            self._clock(first)
        return not self.left

    def _clock(self, trace: Trace) -> None:
        if self.clocked < _CLOCKED_TICKS:
            self.clocked += len(trace.tick_seconds)
            self.tick_seconds.append(trace.tick_seconds)
            self.law_seconds += [] if trace.law_seconds is None else [trace.law_seconds]

    def reserve(self, repetitions: int) -> None:
        """Extend the collector to a number of repetitions, including those that have ended."""
        more = repetitions - len(self.values)
        self.left += more
        self.values = np.vstack([self.values, np.full((more, len(self.names)), np.nan)])

    def join(self, later: "Collector") -> None:
        """Add the results of later repetitions of the same run."""
        if later.names:
            self.put(range(later.first, later.first + len(later.values)), later.names, later.values)
        if later.failure is not None:
            self.fail(*later.failure)
        self.watch.join(later.watch)
        self.notices += later.notices
        self.end(len(later.values), later.seconds / len(later.values), None)

    @cached_property
    def caveats(self) -> Found:
        """Caveats of the complete run."""
        return self.watch.found()

    @property
    def timing(self) -> dict[str, float | None]:
        """Measured times."""
        laws = np.concatenate(self.law_seconds) if self.law_seconds else None
        return timing(np.concatenate(self.tick_seconds), self.seconds, self.seconds, laws)

    def of_first(self) -> dict[str, float | None]:
        """Return the metrics of the first repetition; none if it failed."""
        if self.trace is None or self.trace.failure is not None:
            return {}
        pairs = zip(self.names, self.values[0].tolist(), strict=True)
        return {name: None if math.isnan(value) else value for name, value in pairs}

    def result(
        self,
        error: PlantError | None = None,
        growth: RoundingGrowth | None = None,
        warnings: Sequence[str] = (),
        clock: Mapping[str, float] | None = None,
    ) -> RunResult:
        """Return the result of the complete run.

        Args:
            error: Integration error of the run.
            growth: Growth of rounding errors in the run.
            warnings: Warnings during its simulation, before those of its metrics.
            clock: Measured wall-clock and CPU time, in s; None for the time of its repetitions.
        """
        config = self.config
        assert self.trace is not None  # noqa: S101 - it is complete
        step = PlantStep(config.plant.kind, config.timing.step, config.timing.tick, config.robot.settling_band)
        return RunResult(
            config=config,
            trace=self.trace,
            metrics=summarize_arrays(self.names, self.values),
            caveats=self.caveats if error is None and growth is None else self.watch.found(error, step, growth),
            failure=self.failure,
            timing={**self.timing, **(clock or {})},
            provenance=job_provenance(config, [*warnings, *dict.fromkeys(self.notices)]),
            plant_error=error,
            rounding=growth,
        )


def measure_repetition(
    trace: Trace, context: MetricContext, notices: list[str]
) -> tuple[Trace, Mapping[str, float | None]]:
    """Return a trace and its metrics; none if it failed, or if a plug-in fails, which fails the trace at its end.

    Args:
        trace: Trace of a repetition.
        context: Context of the metrics.
        notices: List that receives a message for each fault in user-supplied metrics.
    """
    try:
        return trace, evaluate(trace, context, notices)
    except SimulationError as error:
        return replace(trace, failure=Failure(error.reason, float(trace.t[-1]))), {}


def timing(
    tick_seconds: np.ndarray, wall_s: float, cpu_s: float, law_seconds: np.ndarray | None = None
) -> dict[str, float | None]:
    """Return the record of measured times.

    Args:
        tick_seconds: Time of each tick, shape (N,), in s; a run that failed at its start has no tick.
        wall_s: Wall-clock time of the run, in s.
        cpu_s: CPU time of the run, in s.
        law_seconds: Time of the control loops in each tick, shape (N,), in s; None if it was not measured.
    """
    median, p99 = np.percentile(tick_seconds, [50, 99]).tolist() if len(tick_seconds) else (None, None)
    record = {"tick_time_median": median, "tick_time_p99": p99, "wall_s": wall_s, "cpu_s": cpu_s}
    if law_seconds is not None and len(law_seconds):
        names = ("law_time_median", "law_time_p99", "law_time_p999", "law_time_max")
        record |= dict(zip(names, np.percentile(law_seconds, [50, 99, 99.9, 100]).tolist(), strict=True))
        record["load_average"] = os.getloadavg()[0]
    return record


def metric_context(config: RunConfig) -> MetricContext:
    """Return the data of a run that metrics need besides its trace."""
    return MetricContext(config.path, config.robot.settling_band, config.timing.tick, reach_of(config.controller))


def reach_of(controller: ControllerConfig) -> float | None:
    """Return the distance up to which a mounted stage follows its target, in m; None without such a limit."""
    return controller.reach if isinstance(controller, FollowsWithinReach) else None
