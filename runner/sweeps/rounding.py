"""Metrics of a sweep that are sensitive to rounding, for its baseline."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from runner.base import progress
from runner.base.errors import RunnerError
from runner.caveats.rounding_growth import SENSITIVE
from runner.store.run import Run
from runner.store.sweep import Sweep

MOST_RUNS = 50
"""Largest number of runs that are simulated again."""


@dataclass
class RoundingSensitivity:
    """Metrics of the runs of a sweep that are sensitive to rounding.

    Attributes:
        changes: Relative change of each sensitive metric, by the hash of the run.
        lost: Reason for each run that cannot be simulated again, by its hash.
        left: Hashes of further runs, which are not simulated because there are too many.
    """

    changes: dict[str, Mapping[str, float]] = field(default_factory=dict)
    lost: dict[str, str] = field(default_factory=dict)
    left: set[str] = field(default_factory=set)

    def in_words(self) -> str:
        """Return the number of sensitive metrics and of runs that are not marked, as lines after a first one."""
        count = sum(map(len, self.changes.values()))
        texts = [f"{count} {'is' if count == 1 else 'are'} sensitive to rounding"] if count else []
        if self.lost:
            why = next(iter(self.lost.values()))
            texts.append(f"{len(self.lost)} runs are not marked because they cannot be simulated again, such as {why}")
        if self.left:
            texts.append(f"{len(self.left)} runs are not marked because only {MOST_RUNS} are simulated again")
        return "".join(f"\n{text}" for text in texts)


def find_sensitive(sweep: Sweep) -> RoundingSensitivity:
    """Find the sensitive metrics of the runs of a sweep, from their records or by simulation of repetition 0.

    Nothing is simulated if a run failed, because such a sweep has no baseline.

    Raises:
        StoreError: if a run is missing or damaged.
    """
    found, unknown = RoundingSensitivity(), dict[str, Run]()
    for run in sweep.runs():
        if run.failure is not None:
            return RoundingSensitivity()
        if run.rounding is not None:
            found.changes[run.hash] = _sensitive(run.rounding["metrics"])
        elif run.hash in unknown or len(unknown) < MOST_RUNS:
            unknown[run.hash] = run
        else:
            found.left.add(run.hash)
    progress.begin("moving the start", len(unknown), "runs")
    for name, run in unknown.items():
        try:
            found.changes[name] = _measure(run)
        except RunnerError as error:
            found.lost[name] = str(error)
        progress.step()
    return found


def _measure(run: Run) -> Mapping[str, float]:
    # Imports of the simulator, which runs with known changes do not need
    from runner.simulation.run import measure_rounding
    from runner.sweeps.rerun import checked_config

    return _sensitive(measure_rounding(checked_config(run)).metrics)


def _sensitive(changes: Mapping[str, float]) -> Mapping[str, float]:
    return {name: change for name, change in changes.items() if change > SENSITIVE}
