"""Queue of the trials of a tuning, chosen during execution."""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from runner import store
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.composer import Composer
from runner.config.composed import Composed
from runner.sweeps.job import RunJob
from runner.sweeps.plan import Grid
from runner.sweeps.queue import Queue
from runner.sweeps.tuning.journal import Journal
from runner.sweeps.tuning.objective import Trial
from runner.sweeps.tuning.sampler import propose
from runner.sweeps.tuning.study import TuningDefinition
from runner.sweeps.work import Chunk, ChunkResult
from runner.sweeps.writer import Rules


class TrialQueue(Queue):
    """Queue that chooses a trial when a place is free, and appends finished trials to the journal in order.

    Trial n depends only on the seed and the trials up to n - at_once. It does not depend on the number of processes,
    their speed, or interruptions of the tuning.

    Args:
        study: Definition of the tuning.
        journal: Journal of the finished trials.
        loader: Composer of the configs.
        rules: Rules for the execution and storage of the runs.
        trials: Number of trials after which to end.
        seed: Seed of the search.
    """

    def __init__(
        self, study: TuningDefinition, journal: Journal, loader: Composer, rules: Rules, trials: int, seed: int
    ) -> None:
        self._runs: list[str] = []
        self._costs_of_runs: list[int] = []
        self._cell_of: dict[str, int] = {}
        super().__init__(self._composed, self._runs, self._costs_of_runs, np.zeros(0, dtype=np.intp), rules)
        self._study, self._journal, self._loader = study, journal, loader
        self._trials, self._seed = trials, seed
        self._started = deque[Trial]()  # without values
        self._configs: dict[int, Composed] = {}
        self._ends: dict[str, store.RunOutcome] = {}

    @property
    def left(self) -> int:
        """Number of unfinished trials."""
        return max(0, self._trials - len(self._journal.trials))

    def _composed(self, cells: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Composed]]]:
        """Yield each cell with its config; cells are numbered in the order of their calls of `put`."""
        return (([cell], [self._configs[cell]]) for cell in cells)

    def take(self, workers: int) -> Chunk | None:
        """Return the next runs, or None if other trials must end before the next choice; see Queue."""
        while len(self._started) < min(self._study.at_once, self.left):
            self._start(self._choose())
            self._settle()
        return super().take(workers)

    def learn(self, report: ChunkResult) -> None:
        """Update the time for a tick from the report of a chunk, and add the outcomes of its runs."""
        super().learn(report)
        self.note(report.outcomes)

    def note(self, outcomes: Sequence[store.RunOutcome]) -> None:
        """Add the outcomes of runs.

        Raises:
            RunnerError: if a successful run lacks the metric of an objective.
            StoreError: if a run cannot be read, or the journal cannot be written.
        """
        for end in outcomes:
            self._ends[end.name] = end
            self._configs.pop(self._cell_of[end.name], None)
        self._settle()

    def _choose(self) -> dict[str, float]:
        chosen = [trial.params for trial in self._journal.trials] + [trial.params for trial in self._started]
        known = max(0, len(chosen) + 1 - self._study.at_once)
        return propose(
            self._study.keys, self._study.objectives, self._journal.history[:known], chosen[known:], self._seed
        )

    def _start(self, params: Mapping[str, float]) -> None:
        overrides = [*self._study.overrides, *(key.override(params[key.name]) for key in self._study.keys)]
        try:
            composed = Grid(overrides, self._loader).composed(0)
            job = RunJob(validate(composed))
            run = job.name
        except ConfigError as error:
            self._started.append(Trial(params, (), "", "; ".join(error.problems)))
            return
        self._started.append(Trial(params, (), run, ""))
        if run not in self._cell_of:
            cell = self._cell_of[run] = len(self._runs)
            self._runs.append(run)
            self._costs_of_runs.append(job.ticks)
            self._configs[cell] = composed
            self.put(cell)

    def _settle(self) -> None:
        """Append the finished trials to the journal, up to the first unfinished one."""
        while self._started and (self._started[0].failure or self._started[0].run in self._ends):
            self._journal.append(self._judge(self._started[0]))
            self._started.popleft()

    def _judge(self, started: Trial) -> Trial:
        objectives = self._study.objectives
        failure = started.failure or self._ends[started.run].failure
        if not failure:
            run = store.open_run(self.rules.outputs / "runs" / started.run)
            found = [objective.read(run) for objective in objectives]
            values = tuple(value for value in found if value is not None)
            if len(values) == len(found):
                return replace(started, values=values)
            beyond = [objective.metric for objective, value in zip(objectives, found, strict=True) if value is None]
            failure = f"{', '.join(beyond)}: beyond every number"
        return replace(started, values=tuple(objective.worst for objective in objectives), failure=failure)
