"""Writer of a sweep's runs, and the rules for traces, failures, attempts and time limits."""

from collections.abc import Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from runner import store
from runner.base.atomic import write_atomically
from runner.config.limits import SweepConfig
from runner.simulation.results import RunResult
from runner.store.shards import ShardRow, outcome, write_shard
from runner.sweeps.records import make_record, write_run

TraceKeeping = Literal["all", "sample", "failed", "never"]

_SAMPLE = 100  # one run in this many, up to _LARGEST_SAMPLE runs
_LARGEST_SAMPLE = 200  # runs: a run with its trace is four files


@dataclass(frozen=True)
class Rules:
    """Rules for the execution and storage of the runs of a sweep.

    Attributes:
        plugins: Plug-ins of the command line.
        outputs: Outputs folder, absolute; all workers must have access to it.
        sweep: Folder of the sweep, absolute.
        trace: Selection of the runs that keep their trace.
        settings: Settings of the sweep; `trace` and `accept_cut_short` are derived from them.
        accept_cut_short: True if a stored run that was aborted counts as done.
        one_in: Number of runs for each run in the sample that keeps its trace.
        command: Random name of the command, for the names of its files and tasks.
    """

    plugins: Sequence[str]
    outputs: Path
    sweep: Path
    trace: TraceKeeping
    settings: SweepConfig
    accept_cut_short: bool
    one_in: int = _SAMPLE
    command: str = ""

    @property
    def stop_at_failure(self) -> bool:
        """True if the first failed run ends the sweep."""
        return self.settings.on_failure == "stop"

    @property
    def kept(self) -> float:
        """Fraction of the successful runs that keep their trace."""
        return 1.0 / self.one_in if self.trace == "sample" else float(self.trace == "all")

    def keeps_trace(self, name: str, failed: bool) -> bool:
        """Return True if a run keeps its trace, in a separate folder."""
        if self.trace == "sample":
            return failed or int(name, 16) % self.one_in == 0
        return self.trace == "all" or (failed and self.trace == "failed")

    def log(self, name: str) -> Path:
        """Return the log file of a failed run that has no separate folder."""
        return self.sweep / "logs" / f"{name}.txt"

    def details(self, name: str) -> Path:
        """Return the file with the details of a failed run: its log, or the record in its folder."""
        return log if (log := self.log(name)).exists() else self.outputs / "runs" / name / "metrics.json"

    def accepts(self, end: store.RunOutcome | None) -> bool:
        """Return True if a stored run counts as done."""
        return end is not None and self.accepts_rank(end.rank)

    def accepts_rank(self, rank: int) -> bool:
        """Return True if a stored run whose outcome has this rank counts as done; see Outcome."""
        return rank == 0 or (self.settings.retry == "none" and (self.accept_cut_short or rank == 1))


def one_in(runs: int) -> int:
    """Return the number of runs for each run in the sample of a sweep: a hundred, or a multiple of it."""
    return _SAMPLE * max(1, -(-runs // (_SAMPLE * _LARGEST_SAMPLE)))


class ResultWriter:
    """Writer of the runs of a chunk; writes a run while the next ones are simulated, because writing takes time.

    Args:
        name: Name of the shard.
        rules: Rules for the storage of the runs.
        disk: Executor of the write operations.
        outcomes: List that receives the outcome of each run; a run with a trace is stored first.
    """

    def __init__(self, name: str, rules: Rules, disk: Executor, outcomes: list[store.RunOutcome]) -> None:
        self._name, self._rules, self._disk, self._outcomes = name, rules, disk, outcomes
        self._written: Future[store.Run] | None = None
        self._traceless: list[store.Run | ShardRow] = []

    def put(self, name: str, made: RunResult | store.Run | store.RunOutcome) -> bool:
        """Add a run, or the outcome of a stored calibration; return True if it failed."""
        if not isinstance(made, RunResult):
            self._traceless += [made] if isinstance(made, store.Run) else []
            self._outcomes.append(outcome(made) if isinstance(made, store.Run) else made)
            return bool(self._outcomes[-1].failure)
        self._wait()
        self._written = self._disk.submit(write_run, self._rules.outputs, name, made)
        return made.failure is not None

    def put_rows(self, rows: Sequence[ShardRow]) -> None:
        """Add successful runs that keep no trace."""
        self._traceless += rows
        self._outcomes += [row.outcome for row in rows]

    def close(self) -> None:
        """Write the remaining runs.

        Raises:
            StoreError: if the disk cannot be written to.
        """
        self._wait()
        if self._traceless:
            write_shard(self._rules.outputs, self._name, self._traceless)

    def _wait(self) -> None:
        if self._written is not None:
            self._outcomes.append(outcome(self._written.result()))
            self._written = None


def without_trace(name: str, result: RunResult, rules: Rules) -> RunResult | store.Run:
    """Return a result as stored: whole, or without its trace; then also log a failure."""
    if rules.keeps_trace(name, result.failure is not None):
        return result
    folder, record = rules.outputs / "runs" / name, make_record(result)
    run = store.Run(
        folder,
        result.config.resolved,
        record,
        result.config.arm.urdf,
        beside=lambda metric: result.metrics[metric].values,
    )
    if run.failure:
        write_failure(run, "", rules)
    return run


def write_failure(run: store.Run, details: str, rules: Rules) -> None:
    """Write the log of a failed run that has no separate folder.

    Raises:
        StoreError: if the disk cannot be written to.
    """
    write_log(run.hash, f"{run.provenance['command']}\n{run.failure}\n{details}", rules)


def write_log(name: str, text: str, rules: Rules) -> None:
    """Write the log of a failed job that has no separate folder.

    Raises:
        StoreError: if the disk cannot be written to.
    """
    write_atomically(rules.log(name), text.encode())
