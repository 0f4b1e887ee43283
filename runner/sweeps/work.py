"""Worker of a sweep: simulation and storage of a chunk of runs and calibrations."""

import contextlib
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, cast

from runner import store
from runner.assembly.run_config import RunConfig
from runner.base.engines import quiet_environment
from runner.base.errors import DISK_FULL, RunnerError, StoreError, describe_write_error, user_place
from runner.base.ticks import report_ticks
from runner.config.composed import CALIBRATION, Composed
from runner.plugins.discovery import use_only
from runner.simulation.provenance import job_provenance
from runner.simulation.results import RunResult
from runner.store.shards import find_shards, outcome, read_outcomes, write_shard
from runner.sweeps.batch import make_together
from runner.sweeps.deadline import STUCK, TimeLimitError, deadline
from runner.sweeps.job import CalibrationJob, RunJob, check_job
from runner.sweeps.records import cut_short_record
from runner.sweeps.writer import ResultWriter, Rules, without_trace, write_failure, write_log

Made = TypeVar("Made")

_one_at_a_time = threading.Lock()  # in case a worker has several threads


@dataclass(frozen=True)
class SeedPart:
    """Runs whose configs differ only in the seed, or a single run or calibration.

    Attributes:
        names: Hash of each run or calibration.
        configs: Composed config of each run or calibration.
    """

    names: Sequence[str]
    configs: Sequence[Composed]


@dataclass(frozen=True)
class Chunk:
    """Runs and calibrations for one worker.

    Attributes:
        name: Name of the shard.
        rules: Rules for the execution and storage of the jobs.
        parts: The jobs, grouped if they differ only in the seed.
    """

    name: str
    rules: Rules
    parts: Sequence[SeedPart]

    @property
    def names(self) -> list[str]:
        """Hash of each job."""
        return [name for part in self.parts for name in part.names]

    @property
    def jobs(self) -> list[tuple[str, Composed]]:
        """Hash and composed config of each job."""
        return [job for part in self.parts for job in zip(part.names, part.configs, strict=True)]


@dataclass(frozen=True)
class ChunkResult:
    """Result of a chunk.

    Attributes:
        outcomes: Outcomes of the jobs, including cached ones.
        trouble: Reason why the chunk stopped early, if other runs would fail for the same reason; empty otherwise.
        seconds: Wall-clock time of the chunk, in s.
        host: Name of the machine that executed the chunk; empty for the process of the command.
        worker: Address of the worker that executed the chunk; empty for the process of the command.
    """

    outcomes: Sequence[store.RunOutcome]
    trouble: str
    seconds: float
    host: str = ""
    worker: str = ""


def work(
    chunk: Chunk, tell: Callable[[int], None] | None = None, go_on: Callable[[], bool] = lambda: True
) -> ChunkResult:
    """Execute the jobs of a chunk; a chunk that was interrupted before continues.

    Args:
        chunk: The chunk.
        tell: Callback that receives the number of finished ticks each second, from a thread.
        go_on: Function called before each job or batch of jobs; none starts after it has returned False.
    """
    quiet_environment()
    start = time.perf_counter()
    outcomes: list[store.RunOutcome] = []
    trouble = ""
    with _one_at_a_time, report_ticks(tell), ThreadPoolExecutor(1) as disk:
        try:
            use_only(chunk.rules.plugins)
            if not (chunk.rules.sweep / "sweep.json").exists():
                raise StoreError(
                    f"a worker does not see {chunk.rules.sweep}; outputs must be a folder that all workers share"
                )
            _make_all(chunk, disk, outcomes, go_on)
        except RunnerError as error:
            trouble = str(error)
    return ChunkResult(outcomes, trouble, time.perf_counter() - start)


def _make_all(chunk: Chunk, disk: Executor, outcomes: list[store.RunOutcome], go_on: Callable[[], bool]) -> None:
    """Execute the jobs of a chunk: first those that can share a batch, then the others one by one."""
    rules, known = chunk.rules, find_stored(chunk)
    outcomes += known.values()
    writer = ResultWriter(chunk.name, rules, disk, outcomes)
    parts = [[job for job in zip(part.names, part.configs, strict=True) if job[0] not in known] for part in chunk.parts]
    left = [job for part in parts for job in part]
    jobs = list(_checked_runs(parts))
    made, failed = make_together(jobs, rules, writer, go_on) if len(jobs) > 1 else (set(), False)
    for name, composed in left:
        if (failed and rules.stop_at_failure) or not go_on():
            break
        if name not in made:
            failed = writer.put(name, _make(name, composed, rules))
    writer.close()


def find_stored(chunk: Chunk) -> dict[str, store.RunOutcome]:
    """Return the outcomes of the jobs of a chunk that are in its shard or count as done.

    Damaged results are left out.
    """
    found, outputs, names = {}, chunk.rules.outputs, set(chunk.names)
    for part in chunk.parts:
        find = find_calibrated if part.configs[0].root == CALIBRATION else store.find_outcome
        for name in part.names:
            with contextlib.suppress(store.DamagedError):
                end = find(outputs, name)
                if chunk.rules.accepts(end) and end is not None:
                    found[name] = end
    for shard in find_shards(outputs, chunk.name):
        with contextlib.suppress(store.DamagedError):
            found |= {end.name: end for end in read_outcomes(shard) if end.name in names}
    return found


def find_calibrated(outputs: Path, name: str) -> store.RunOutcome | None:
    """Return a successful outcome if a calibration is stored, otherwise None.

    Raises:
        DamagedError: if the calibration is damaged.
    """
    return None if store.find_calibration(outputs, name) is None else store.RunOutcome(name, "", False)


def _make(name: str, composed: Composed, rules: Rules) -> RunResult | store.Run | store.RunOutcome:
    """Make one job; return a run as stored, or the outcome of a stored calibration."""
    job = _checked(name, composed)
    result: Any
    result, reason, details = _try(job.simulate, rules)
    if result is None:
        return cut_short(job, rules, reason, details)
    if isinstance(result, RunResult):
        return without_trace(name, result, rules)
    job.write(rules.outputs, result)
    return store.RunOutcome(name, "", False)


def _checked_runs(parts: Sequence[Sequence[tuple[str, Composed]]]) -> Iterator[tuple[str, RunConfig]]:
    """Yield the runs among the jobs with their checked configs; runs that differ only in the seed are checked once.

    This is sufficient: the command has checked all runs, and every run reveals a worker with other source code.
    """
    known: dict[tuple[object, ...], RunConfig] = {}
    for part in parts:
        if not part or part[0][1].root == CALIBRATION:
            continue
        name, first = part[0]
        shared = tuple((key, id(group)) for key, group in first.resolved.items() if key != "seed")
        checked = known.get(shared)
        if checked is None:
            checked = known[shared] = cast(RunJob, _checked(name, first)).config
        for name, composed in part:
            yield name, checked.with_seed(composed)


def _checked(name: str, composed: Composed) -> RunJob | CalibrationJob:
    job = check_job(composed)
    if job.name != name:
        raise StoreError("a worker has other source code or libraries than the command; install the same version there")
    return job


def _try(make: Callable[[], Made], rules: Rules) -> tuple[Made | None, str, str]:
    """Return the result, or None with the reason of the failure and the traceback of an error."""
    limit = rules.settings.time_limit
    for _ in range(rules.settings.attempts):
        try:
            with deadline(limit):
                return make(), "", ""
        except TimeLimitError as error:
            place = user_place(error)
            found = f"no result within sweep.time_limit, {limit:g} s{f' ({place})' if place else ''}", ""
        except Exception as error:
            if isinstance(error, OSError) and error.errno in DISK_FULL:  # the run is not the cause
                raise StoreError(describe_write_error(error)) from error
            place = user_place(error)
            found = f"{type(error).__name__}: {error}{f' ({place})' if place else ''}", traceback.format_exc()
    return None, *found


def give_up(chunk: Chunk, deaths: int) -> ChunkResult:
    """Store the single job of a chunk as aborted, because this number of workers died at it."""
    reason = f"its worker process died {deaths} times"
    if chunk.rules.settings.time_limit is not None:
        reason += f", by itself or because it could not be interrupted for {STUCK:g} s after sweep.time_limit"
    (composed,), rules = [composed for _, composed in chunk.jobs], chunk.rules
    made = cut_short(check_job(composed), rules, reason)
    if isinstance(made, store.RunOutcome):
        return ChunkResult([made], "", 0.0)
    write_shard(rules.outputs, chunk.name, [made])
    return ChunkResult([outcome(made)], "", 0.0)


def cut_short(
    job: RunJob | CalibrationJob, rules: Rules, reason: str, details: str = ""
) -> store.Run | store.RunOutcome:
    """Log a job that ended for another reason than its physics; return a run as stored, or an outcome."""
    if isinstance(job, CalibrationJob):
        write_log(job.name, f"{reason}\n{details}", rules)
        return store.RunOutcome(job.name, f"cut short: {reason}", cut_short=True)
    config = job.config
    record = cut_short_record(reason, config.settings.repetitions, job_provenance(config))
    run = store.Run(rules.outputs / "runs" / job.name, config.resolved, record, config.arm.urdf)
    write_failure(run, details, rules)
    return run
