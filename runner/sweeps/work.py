"""What a worker does with a chunk of runs: simulate those that are not stored yet, and store them."""

import contextlib
import signal
import threading
import time
import traceback
from collections.abc import Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner import store
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
        stop_at_failure: Whether the first failed run ends the sweep.
        attempts: How often a run is tried that is cut short.
        time_limit: Longest wall-clock time of a run, in s; None for no limit.
    """

    plugins: Sequence[str]
    outputs: Path
    sweep: Path
    trace: TraceKeeping
    accept_failed: bool
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
        return end is not None and (self.accept_failed or not end.failure)


@dataclass(frozen=True)
class Chunk:
    """Some runs for one worker.

    Attributes:
        name: Name of its shard.
        rules: How they are made and kept.
        runs: Hash and composed config of each.
    """

    name: str
    rules: Rules
    runs: Sequence[tuple[str, Composed]]


@dataclass(frozen=True)
class Report:
    """What became of a chunk.

    Attributes:
        outcomes: How its runs ended, those that were stored already included.
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
    """Make the runs of a chunk; while one is simulated, the one before is written, as the disk takes its time."""
    rules, known = chunk.rules, find_stored(chunk)
    traceless: list[ShardRun] = []
    written: Future[store.Run] | None = None
    for name, composed in chunk.runs:
        if name in known:
            outcomes.append(known[name])
            failed = bool(known[name].failure)
        else:
            made = _make(name, composed, rules)
            failed = bool(made.failure)
            if isinstance(made, ShardRun):
                traceless.append(made)
                outcomes.append(outcome(made))
            else:
                if written is not None:
                    outcomes.append(outcome(written.result()))
                written = disk.submit(store.write_run, rules.outputs, name, made)
        if failed and rules.stop_at_failure:
            break
    if written is not None:
        outcomes.append(outcome(written.result()))
    if traceless:
        write_shard(rules.outputs, chunk.name, traceless)


def find_stored(chunk: Chunk) -> dict[str, store.Outcome]:
    """Return how the runs of a chunk ended that need not be made: they are in its shard, or count as done.

    What is damaged is none of them.
    """
    found = {}
    for name, _ in chunk.runs:
        with contextlib.suppress(store.DamagedError):
            end = store.find_outcome(chunk.rules.outputs, name)
            if end is not None and chunk.rules.accepts(end):
                found[name] = end
    for shard in find_shards(chunk.rules.outputs, chunk.name):
        with contextlib.suppress(store.DamagedError):
            found |= {end.name: end for end in read_outcomes(shard)}
    return found


def _check_folder(rules: Rules) -> None:
    if not (rules.sweep / "sweep.json").exists():
        raise StoreError(f"a worker does not see {rules.sweep}; outputs must be a folder that all workers share")


def _make(name: str, composed: Composed, rules: Rules) -> store.RunResult | ShardRun:
    """Simulate one run; return what is to be stored, in a folder of its own or in a shard."""
    config = validate(composed.resolved, composed.config_dirs)
    if store.run_hash(composed.resolved, config.arm.urdf) != name:
        raise StoreError("a worker has other source code or libraries than the command; install the same version there")
    for _ in range(rules.attempts):
        result, reason, details = _try(config, composed, rules.time_limit)
        if result is not None:
            break
    if result is None:
        run = cut_short(name, config, composed, rules, reason)
    elif rules.keeps_trace(name, result.failure is not None):
        return result
    else:
        run = ShardRun(rules.outputs / "runs" / name, composed.resolved, make_record(result), config.arm.urdf)
    if run.failure:
        write_log(run, rules, details)
    return run


def _try(config: RunConfig, composed: Composed, limit: float | None) -> tuple[store.RunResult | None, str, str]:
    """Return the result, or why there is none, and the traceback of an error of ours or of a part that was added."""
    try:
        with deadline(limit):
            return simulate_job(config, composed), "", ""
    except TimeLimitError as error:
        place = user_place(error)
        return None, f"no result within sweep.time_limit, {limit:g} s{f' ({place})' if place else ''}", ""
    except Exception as error:
        place = user_place(error)
        reason = f"{type(error).__name__}: {error}{f' ({place})' if place else ''}"
        return None, reason, traceback.format_exc()


def cut_short(name: str, config: RunConfig, composed: Composed, rules: Rules, reason: str) -> ShardRun:
    """Return what is stored of a run that something else than its physics ended."""
    record = cut_short_record(reason, config.settings.repetitions, job_provenance(config, composed))
    return ShardRun(rules.outputs / "runs" / name, composed.resolved, record, config.arm.urdf)


def write_log(run: ShardRun, rules: Rules, details: str = "") -> None:
    """Write down why a run without a folder of its own failed.

    Raises:
        StoreError: if the disk does not take it.
    """
    text = f"{run.provenance['command']}\n{run.failure_text}\n{details}"
    write_atomically(rules.log(run.hash), text.encode())
