"""Writer of a sweep's runs, and the rules for traces, failures, attempts and time limits."""

from collections.abc import Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner import store
from runner.simulation.result import RunResult
from runner.store.atomic import write_atomically
from runner.store.shards import ShardRow, outcome, write_shard
from runner.store.writing import make_record

TraceKeeping = Literal["all", "sample", "failed", "never"]

_SAMPLE = 100  # one run in so many, where that makes no more than
_LARGEST_SAMPLE = 200  # runs: a run with its trace is four files


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
        one_in: One run in so many keeps its trace where a sample does.
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
    one_in: int = _SAMPLE

    @property
    def kept(self) -> float:
        """Share of the runs that end well which keep their trace."""
        return 1.0 / self.one_in if self.trace == "sample" else float(self.trace == "all")

    def keeps_trace(self, name: str, failed: bool) -> bool:
        """Tell whether a run keeps its trace, and with it a folder of its own."""
        if self.trace == "sample":
            return failed or int(name, 16) % self.one_in == 0
        return self.trace == "all" or (failed and self.trace == "failed")

    def log(self, name: str) -> Path:
        """Return the file that says why a run without a folder of its own failed."""
        return self.sweep / "logs" / f"{name}.txt"

    def accepts(self, end: store.Outcome | None) -> bool:
        """Tell whether a stored run counts as done."""
        return end is not None and self.accepts_rank(end.rank)

    def accepts_rank(self, rank: int) -> bool:
        """Tell whether a stored run does whose outcome has a rank; see Outcome."""
        return rank == 0 or (self.accept_failed and (self.accept_cut_short or rank == 1))


def one_in(runs: int) -> int:
    """Return the number of runs of a sweep of which one is in its sample: a hundred, or a multiple of it."""
    return _SAMPLE * max(1, -(-runs // (_SAMPLE * _LARGEST_SAMPLE)))


class ResultWriter:
    """Takes runs; while the next ones are simulated, the one before is written, as the disk takes its time.

    Args:
        name: Name of the shard.
        rules: How runs are kept.
        disk: Writes.
        outcomes: Takes how runs ended, as soon as those with traces are stored.
    """

    def __init__(self, name: str, rules: Rules, disk: Executor, outcomes: list[store.Outcome]) -> None:
        self._name, self._rules, self._disk, self._outcomes = name, rules, disk, outcomes
        self._written: Future[store.Run] | None = None
        self._traceless: list[store.Run | ShardRow] = []

    def put(self, name: str, made: RunResult | store.Run) -> bool:
        """Take a run, and tell whether it failed."""
        if isinstance(made, store.Run):
            self._traceless.append(made)
            self._outcomes.append(outcome(made))
            return bool(self._outcomes[-1].failure)
        self._wait()
        self._written = self._disk.submit(store.write_run, self._rules.outputs, name, made)
        return made.failure is not None

    def put_rows(self, rows: Sequence[ShardRow]) -> None:
        """Take runs that ended well and keep no trace."""
        self._traceless += rows
        self._outcomes += [row.outcome for row in rows]

    def close(self) -> None:
        """Write what is left.

        Raises:
            StoreError: if the disk does not take it.
        """
        self._wait()
        if self._traceless:
            write_shard(self._rules.outputs, self._name, self._traceless)

    def _wait(self) -> None:
        if self._written is not None:
            self._outcomes.append(outcome(self._written.result()))
            self._written = None


def without_trace(name: str, result: RunResult, rules: Rules) -> RunResult | store.Run:
    """Return a result as it is kept: whole, or without its trace; then a failure is written down, too."""
    if rules.keeps_trace(name, result.failure is not None):
        return result
    folder, record = rules.outputs / "runs" / name, make_record(result)
    run = store.Run(folder, result.resolved, record, result.urdf, beside=lambda metric: result.metrics[metric].values)
    if run.failure:
        write_failure(run, "", rules)
    return run


def write_failure(run: store.Run, details: str, rules: Rules) -> None:
    """Write down why a run without a folder of its own failed.

    Raises:
        StoreError: if the disk does not take it.
    """
    write_log(run.hash, f"{run.provenance['command']}\n{run.failure}\n{details}", rules)


def write_log(name: str, text: str, rules: Rules) -> None:
    """Write down why a job without a folder of its own failed.

    Raises:
        StoreError: if the disk does not take it.
    """
    write_atomically(rules.log(name), text.encode())
