"""What the laws did on one arm under one condition: errors along every path, and which law is ahead of which."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.errors import RunnerError
from runner.reporting.job import Made
from runner.reporting.prose.patterns import found
from runner.store import Run, simulated_part
from runner.sweeps.differing import entries
from runner.works.benchmark.leads import Entry, FloatArray, Lead, leads

UNTUNED = ("untuned",)
"""The gains that follow from the arm's bandwidth."""
ALL_SEEDS = slice(None)

_METRIC = "rms_tracking_error"
_LAW = ("controller", "disturbance_observer")


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
    def tied(self) -> list[str]:
        """The laws that the best one is not shown to be ahead of."""
        return [each.law for each in self.entries[1:] if not self.leads[self.best.law, each.law].shown]

    def entry(self, law: str) -> Entry:
        """Return what a law did."""
        return next(each for each in self.entries if each.law == law)


def tuned(runs: Mapping[str, Run]) -> tuple[str, ...]:
    """Return the gains of the tunings that the runs are to have, in order: "1", "2" and so on."""
    names = [*runs, *(runs.missing if isinstance(runs, Made) else ())]
    last = {name.rpartition("/")[2] for name in names if name.startswith("laws/")}
    return tuple(sorted(own for own in last if own.isdecimal()))


def cells(
    runs: Mapping[str, Run],
    arm: str,
    grid: str = "laws",
    seeds: slice = ALL_SEEDS,
    gains: Sequence[str] = (),
    tasks: Sequence[str] = (),
) -> dict[str, Cell]:
    """Return what the laws did on an arm, by condition.

    Args:
        runs: The runs of the work.
        arm: Level of the axis arm.
        grid: How the runs' names begin: "laws", on Runge-Kutta, or "engine".
        seeds: Which repetitions count of runs that have several.
        gains: Levels of the axis of gains that count; all tunings where none is named.
        tasks: Levels of the axis of tasks that count; all where none is named.

    Raises:
        RunnerError: if the laws of a cell differ in more than the law: in period, plant, path, limits or seeds.
        MissingError: if a run was not made.
    """
    task = f"{{task={'|'.join(tasks)}}}" if tasks else "{task}"
    gains = gains or tuned(runs)
    pattern = f"{grid}/{arm}/{{law}}/{task}/{{condition}}/{{gains={'|'.join(gains)}}}"
    ranked = {name: _ranked(by_law, seeds) for name, by_law in _errors(runs, pattern, gains).items()}
    ahead = leads(ranked)
    return {name: Cell(entered, ahead[name]) for name, entered in ranked.items()}


def errors_of(run: Run) -> FloatArray:
    """Return the error of a run in each repetition, in m, infinite where that failed, shape (n,)."""
    if _METRIC not in run.metrics:
        return np.full(run.config["repetitions"], np.inf)
    errors: FloatArray = np.nan_to_num(run.values(_METRIC), nan=np.inf, posinf=np.inf)
    return errors


def _ranked(by_law: Mapping[str, FloatArray], seeds: slice) -> list[Entry]:
    """Return the laws of a condition, the smallest error first."""
    entered = [Entry(law, errors[..., seeds] if errors.shape[-1] > 1 else errors) for law, errors in by_law.items()]
    return sorted(entered, key=lambda each: each.score)


def _errors(runs: Mapping[str, Run], pattern: str, gains: Sequence[str]) -> dict[str, dict[str, FloatArray]]:
    """Return the errors of each law under each condition, shape (tunings, paths, n), of the runs of a pattern."""
    grouped: dict[str, dict[str, dict[str, dict[str, FloatArray]]]] = {}
    alike: dict[tuple[str, str], tuple[str, dict[str, str]]] = {}
    for one in found(runs, pattern):
        law, task, condition = (one.levels[axis] for axis in ("law", "task", "condition"))
        setting = _setting(one.run)
        first = alike.setdefault((task, condition), (law, setting))
        _check_alike(f"{task}, {condition}", first, (law, setting))
        by_task = grouped.setdefault(condition, {}).setdefault(law, {})
        by_task.setdefault(task, {})[one.levels["gains"]] = errors_of(one.run)
    return {
        condition: {
            law: np.array([[by_task[task][own] for task in by_task] for own in gains])
            for law, by_task in by_law.items()
        }
        for condition, by_law in grouped.items()
    }


def _check_alike(place: str, one: tuple[str, dict[str, str]], other: tuple[str, dict[str, str]]) -> None:
    (law, ours), (their_law, theirs) = one, other
    if ours == theirs:
        return
    key = next(key for key in dict.fromkeys([*ours, *theirs]) if ours.get(key) != theirs.get(key))
    raise RunnerError(
        f"{place}: {key} is {ours.get(key, 'none')} for {law} and {theirs.get(key, 'none')} for {their_law}; laws are "
        "compared where nothing but they and their gains differ"
    )


def _setting(run: Run) -> dict[str, str]:
    """Return all that decides about a run but its law, with what the law carries; of the law the period stays."""
    part = simulated_part(run.config)
    period = {"controller.period": part["controller"]["period"]}
    return dict(entries({key: value for key, value in part.items() if key not in _LAW} | period))
