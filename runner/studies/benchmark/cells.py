"""Results on one arm under one condition: errors along every path, and significant leads."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.store import Run
from runner.studies.benchmark.leads import Entry, Lead, leads
from runner.study.fit import difference, setting
from runner.study.job import Results
from runner.study.prose.patterns import found

UNTUNED = ("untuned",)
"""The gains that follow from the arm's bandwidth."""
ALL_SEEDS = slice(None)

ROUND = 4
"""The round that is judged of a motion that repeats."""

_ONE = ("1",)
_REPEATING = ("learned", "changed")
_OF_ALL = "rms_tracking_error"  # along a motion that does not repeat


@dataclass(frozen=True)
class Cell:
    """An arm under a condition.

    Attributes:
        entries: The laws, the one with the smallest error first.
        leads: Each of them against each that stands behind it, by both names.
    """

    entries: Sequence[Entry]
    leads: Mapping[tuple[str, str], Lead]

    @property
    def best(self) -> Entry:
        """The law with the smallest error."""
        return self.entries[0]

    @property
    def groups(self) -> list[list[str]]:
        """The laws in groups: that of a law is the one after the last one with a law that is shown ahead of it."""
        number: dict[str, int] = {}
        for place, entry in enumerate(self.entries):
            ahead = (each.law for each in self.entries[:place] if self.leads[each.law, entry.law].shown)
            number[entry.law] = 1 + max((number[law] for law in ahead), default=-1)
        return [[law for law, own in number.items() if own == each] for each in range(1 + max(number.values()))]

    def entry(self, law: str) -> Entry:
        """Return what a law did."""
        return next(each for each in self.entries if each.law == law)


def tuned(runs: Mapping[str, Run]) -> tuple[str, ...]:
    """Return the gains of the tunings that the runs are to have, in order: "1", "2" and so on."""
    names = [*runs, *(runs.missing if isinstance(runs, Results) else ())]
    last = {name.rpartition("/")[2] for name in names if name.startswith("first/")}
    return tuple(sorted(own for own in last if own.isdecimal()))


def cells(
    runs: Mapping[str, Run],
    arm: str,
    grid: str = "first",
    seeds: slice = ALL_SEEDS,
    gains: Sequence[str] = (),
    tasks: Sequence[str] = (),
    after: int = ROUND,
) -> dict[str, Cell]:
    """Return what the laws did on an arm, by condition.

    Args:
        runs: The runs of the study.
        arm: Level of the axis arm.
        grid: How the runs' names begin: "first"; "engine", the same on another plant; "learned"; or "changed", where
            the change stands in place of a condition and there is one tuning.
        seeds: Which repetitions count of runs that have several.
        gains: Levels of the axis of gains that count; all tunings where none is named.
        tasks: Levels of the axis of tasks that count; all where none is named.
        after: The round that counts where the motion repeats.

    Raises:
        RunnerError: if the laws of a cell differ in more than the law: in period, plant, path, limits or seeds.
        MissingError: if a run was not made.
    """
    task = f"{{task={'|'.join(tasks)}}}" if tasks else "{task}"
    gains = gains or (_ONE if grid == "changed" else tuned(runs))
    last = "" if grid == "changed" else f"/{{gains={'|'.join(gains)}}}"
    metric = f"{_OF_ALL}_period_{after}" if grid in _REPEATING else _OF_ALL
    errors = _errors(runs, f"{grid}/{arm}/{{law}}/{task}/{{condition}}{last}", gains, metric)
    ranked = {name: _ranked(by_law, seeds) for name, by_law in errors.items()}
    ahead = leads(ranked)
    return {name: Cell(entered, ahead[name]) for name, entered in ranked.items()}


def errors_of(run: Run, metric: str) -> FloatArray:
    """Return a metric of a run in each repetition, infinite where that failed, shape (n,)."""
    if metric not in run.metrics:
        return np.full(run.config["repetitions"], np.inf)
    errors: FloatArray = np.nan_to_num(run.values(metric), nan=np.inf, posinf=np.inf)
    return errors


def _ranked(by_law: Mapping[str, FloatArray], seeds: slice) -> list[Entry]:
    """Return the laws of a condition, the smallest error first."""
    entered = [Entry(law, errors[..., seeds] if errors.shape[-1] > 1 else errors) for law, errors in by_law.items()]
    return sorted(entered, key=lambda each: each.score)


def _errors(
    runs: Mapping[str, Run], pattern: str, gains: Sequence[str], metric: str
) -> dict[str, dict[str, FloatArray]]:
    """Return the errors of each law under each condition, shape (tunings, paths, n), of the runs of a pattern."""
    grouped: dict[str, dict[str, dict[str, dict[str, FloatArray]]]] = {}
    alike: dict[tuple[str, str], tuple[str, dict[str, str]]] = {}
    for one in found(runs, pattern):
        law, task, condition = (one.levels[axis] for axis in ("law", "task", "condition"))
        own = setting(one.run.config)
        first = alike.setdefault((task, condition), (law, own))
        if unlike := difference(first, (law, own)):
            raise RunnerError(f"{task}, {condition}: {unlike}")
        by_task = grouped.setdefault(condition, {}).setdefault(law, {})
        by_task.setdefault(task, {})[one.levels.get("gains", gains[0])] = errors_of(one.run, metric)
    return {
        condition: {
            law: np.array([[by_task[task][own] for task in by_task] for own in gains])
            for law, by_task in by_law.items()
        }
        for condition, by_law in grouped.items()
    }
