"""What a worker does with a chunk of runs and calibrations: make those that are not stored yet, and store them."""

import contextlib
import signal
import threading
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeVar

from runner import store
from runner.calibration_job import CALIBRATION, carry_out
from runner.config.calibration import validate_calibration
from runner.config.compose import Composed, quiet_environment
from runner.config.run import RunConfig
from runner.config.validation import validate
from runner.errors import RunnerError, StoreError, user_place
from runner.execution import job_provenance, simulate_job
from runner.plugins import use_plugins
from runner.store.atomic import write_atomically
from runner.store.shards import ShardRun, find_shards, outcome, read_outcomes, write_shard
from runner.store.writing import cut_short_record, make_record
from runner.sweeps.deadline import TimeLimitError, deadline

TraceKeeping = Literal["all", "sample", "failed", "never"]

Made = TypeVar("Made")

_SAMPLE = 100  # one run in so many
_one_at_a_time = threading.Lock()  # should a worker have several threads


@dataclass(frozen=True)
class Rules:
    """How the runs of a sweep are made and kept.

    Attributes:
        plugins: The user's parts that the command line named.
        outputs: The outputs folder, absolute: every worker must see it.
        sweep: The sweep's folder, absolute.
        trace: Which runs keep their trace.
        accept_failed: Whether a stored run that failed counts as done.
        accept_cut_short: Whether one does that was cut short.
        stop_at_failure: Whether the first failed run ends the sweep.
        attempts: How often a run is tried that is cut short.
        time_limit: Longest wall-clock time of a run, in s; None for no limit.
    """

    plugins: Sequence[str]
    outputs: Path
    sweep: Path
    trace: TraceKeeping
    accept_failed: bool
    accept_cut_short: bool
    stop_at_failure: bool
    attempts: int
    time_limit: float | None

    def keeps_trace(self, name: str, failed: bool) -> bool:
        """Tell whether a run keeps its trace, and with it a folder of its own."""
        if self.trace == "sample":
            return failed or int(name, 16) % _SAMPLE == 0
        return self.trace == "all" or (failed and self.trace == "failed")

    def log(self, name: str) -> Path:
        """Return the file that says why a run without a folder of its own failed."""
        return self.sweep / "logs" / f"{name}.txt"

    def accepts(self, end: store.Outcome | None) -> bool:
        """Tell whether a stored run counts as done."""
        if end is None or not end.failure:
            return end is not None
        return self.accept_failed and (self.accept_cut_short or not end.cut_short)


@dataclass(frozen=True)
class Chunk:
    """Some runs and calibrations for one worker.

    Attributes:
        name: Name of its shard.
        rules: How they are made and kept.
        jobs: Hash and composed config of each.
    """

    name: str
    rules: Rules
    jobs: Sequence[tuple[str, Composed]]


@dataclass(frozen=True)
class Report:
    """What became of a chunk.

    Attributes:
        outcomes: How they ended, those that were stored already included.
        trouble: Why it stopped before its end, where no other run would fare better; empty otherwise.
        seconds: Wall-clock time it took, in s.
    """

    outcomes: Sequence[store.Outcome]
    trouble: str
    seconds: float


def dask_setup(_worker: object) -> None:
    """Leave Ctrl-C to the command, which ends its workers; Dask calls this in each process of `local_client`."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def work(chunk: Chunk) -> Report:
    """Make the runs of a chunk; a chunk that was begun before goes on where it was."""
    quiet_environment()
    start = time.perf_counter()
    outcomes: list[store.Outcome] = []
    trouble = ""
    with _one_at_a_time, ThreadPoolExecutor(1) as disk:
        try:
            use_plugins(chunk.rules.plugins)
            _check_folder(chunk.rules)
            _make_all(chunk, disk, outcomes)
        except RunnerError as error:
            trouble = str(error)
    return Report(outcomes, trouble, time.perf_counter() - start)


def _make_all(chunk: Chunk, disk: Executor, outcomes: list[store.Outcome]) -> None:
    """Make what a chunk asks for; while a run is simulated, the one before is written, as the disk takes its time."""
    rules, known = chunk.rules, find_stored(chunk)
    traceless: list[ShardRun] = []
    written: Future[store.Run] | None = None
    for name, composed in chunk.jobs:
        if name in known:
            end: store.Outcome | None = known[name]
        elif composed.root == CALIBRATION:
            end = _calibrate(name, composed, rules)
        else:
            made, end = _make(name, composed, rules), None
            if isinstance(made, ShardRun):
                traceless.append(made)
                end = outcome(made)
            else:
                if written is not None:
                    outcomes.append(outcome(written.result()))
                written = disk.submit(store.write_run, rules.outputs, name, made)
        if end is not None:
            outcomes.append(end)
        if rules.stop_at_failure and (end.failure if end is not None else made.failure):
            break
    if written is not None:
        outcomes.append(outcome(written.result()))
    if traceless:
        write_shard(rules.outputs, chunk.name, traceless)


def find_stored(chunk: Chunk) -> dict[str, store.Outcome]:
    """Return how those of a chunk ended that need not be made: they are in its shard, or count as done.

    What is damaged is none of them.
    """
    found, outputs = {}, chunk.rules.outputs
    for name, composed in chunk.jobs:
        with contextlib.suppress(store.DamagedError):
            end = find_calibrated(outputs, name) if composed.root == CALIBRATION else store.find_outcome(outputs, name)
            if chunk.rules.accepts(end) and end is not None:
                found[name] = end
    for shard in find_shards(outputs, chunk.name):
        with contextlib.suppress(store.DamagedError):
            found |= {end.name: end for end in read_outcomes(shard)}
    return found


def find_calibrated(outputs: Path, name: str) -> store.Outcome | None:
    """Return that a calibration ended well, or None where it is not stored.

    Raises:
        DamagedError: if it is damaged.
    """
    return None if store.find_calibration(outputs, name) is None else store.Outcome(name, "", False)


def _check_folder(rules: Rules) -> None:
    if not (rules.sweep / "sweep.json").exists():
        raise StoreError(f"a worker does not see {rules.sweep}; outputs must be a folder that all workers share")


def _make(name: str, composed: Composed, rules: Rules) -> store.RunResult | ShardRun:
    """Simulate one run; return what is to be stored, in a folder of its own or in a shard."""
    config = validate(composed.resolved, composed.config_dirs)
    _check_name(name, composed.resolved, config.arm.urdf)
    result, reason, details = _try(lambda: simulate_job(config, composed), rules)
    if result is None:
        run = cut_short(name, config, composed, rules, reason)
    elif rules.keeps_trace(name, result.failure is not None):
        return result
    else:
        run = ShardRun(rules.outputs / "runs" / name, composed.resolved, make_record(result), config.arm.urdf)
    if run.failure:
        write_log(run.hash, f"{run.provenance['command']}\n{run.failure_text}\n{details}", rules)
    return run


def _calibrate(name: str, composed: Composed, rules: Rules) -> store.Outcome:
    """Carry out one calibration and store it; one that is cut short is not stored."""
    config = validate_calibration(composed)
    _check_name(name, config.resolved, config.arm.urdf)
    record, reason, details = _try(lambda: carry_out(config, composed), rules)
    if record is None:
        write_log(name, f"{reason}\n{details}", rules)
        return store.Outcome(name, f"cut short: {reason}", cut_short=True)
    store.write_calibration(rules.outputs, name, config.resolved, config.arm.urdf, record)
    return store.Outcome(name, "", False)


def _check_name(name: str, resolved: Mapping[str, object], urdf: str) -> None:
    if store.run_hash(resolved, urdf) != name:
        raise StoreError("a worker has other source code or libraries than the command; install the same version there")


def _try(make: Callable[[], Made], rules: Rules) -> tuple[Made | None, str, str]:
    """Return what is made, or why it is not, and the traceback of an error of ours or of a part that was added."""
    limit = rules.time_limit
    for _ in range(rules.attempts):
        try:
            with deadline(limit):
                return make(), "", ""
        except TimeLimitError as error:
            place = user_place(error)
            found = f"no result within sweep.time_limit, {limit:g} s{f' ({place})' if place else ''}", ""
        except Exception as error:
            place = user_place(error)
            found = f"{type(error).__name__}: {error}{f' ({place})' if place else ''}", traceback.format_exc()
    return None, *found


def give_up(chunk: Chunk, reason: str) -> Report:
    """Store that the one job of a chunk was cut short, as it brings every worker down."""
    (name, composed), rules = chunk.jobs[0], chunk.rules
    if composed.root == CALIBRATION:
        write_log(name, reason, rules)
        return Report([store.Outcome(name, f"cut short: {reason}", cut_short=True)], "", 0.0)
    config = validate(composed.resolved, composed.config_dirs)
    run = cut_short(name, config, composed, rules, reason)
    write_log(name, f"{run.provenance['command']}\n{run.failure_text}\n", rules)
    write_shard(rules.outputs, chunk.name, [run])
    return Report([outcome(run)], "", 0.0)


def cut_short(name: str, config: RunConfig, composed: Composed, rules: Rules, reason: str) -> ShardRun:
    """Return what is stored of a run that something else than its physics ended."""
    record = cut_short_record(reason, config.settings.repetitions, job_provenance(config, composed))
    return ShardRun(rules.outputs / "runs" / name, composed.resolved, record, config.arm.urdf)


def write_log(name: str, text: str, rules: Rules) -> None:
    """Write down why a job without a folder of its own failed.

    Raises:
        StoreError: if the disk does not take it.
    """
    write_atomically(rules.log(name), text.encode())
