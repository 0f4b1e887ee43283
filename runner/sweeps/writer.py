"""Writer of a chunk's results: a folder for each run with a trace, and one shard for the others."""

from collections.abc import Sequence
from concurrent.futures import Executor, Future

from runner import store
from runner.store.atomic import write_atomically
from runner.store.shards import ShardRow, ShardRun, outcome, write_shard
from runner.store.writing import make_record
from runner.sweeps.rules import Rules


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
        self._traceless: list[ShardRun | ShardRow] = []

    def put(self, name: str, made: store.RunResult | ShardRun) -> bool:
        """Take a run, and tell whether it failed."""
        if isinstance(made, ShardRun):
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


def without_trace(name: str, result: store.RunResult, rules: Rules) -> store.RunResult | ShardRun:
    """Return a result as it is kept: whole, or without its trace; then a failure is written down, too."""
    if rules.keeps_trace(name, result.failure is not None):
        return result
    folder, record = rules.outputs / "runs" / name, make_record(result)
    run = ShardRun(folder, result.resolved, record, result.urdf, beside=lambda metric: result.metrics[metric].values)
    if run.failure:
        write_failure(run, "", rules)
    return run


def write_failure(run: ShardRun, details: str, rules: Rules) -> None:
    """Write down why a run without a folder of its own failed.

    Raises:
        StoreError: if the disk does not take it.
    """
    write_log(run.hash, f"{run.provenance['command']}\n{run.failure_text}\n{details}", rules)


def write_log(name: str, text: str, rules: Rules) -> None:
    """Write down why a job without a folder of its own failed.

    Raises:
        StoreError: if the disk does not take it.
    """
    write_atomically(rules.log(name), text.encode())
