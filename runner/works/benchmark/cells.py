"""What the laws did on one arm under one condition: errors along every path, and which law is ahead of which."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from runner.errors import RunnerError
from runner.reporting.prose.patterns import found
from runner.statistics import Comparison, compare_paired, holm
from runner.store import Run, simulated_part
from runner.sweeps.differing import entries

FloatArray = NDArray[np.float64]

_METRIC = "rms_tracking_error"
_LAW = ("controller", "disturbance_observer")
_SIGNIFICANCE = 0.05
_LEAST = 1.01  # ratio of errors; less is no lead


@dataclass(frozen=True)
class Entry:
    """One law in a cell.

    Attributes:
        law: Name of the law.
        errors: Its error along each path in each repetition, in m; infinite where the run failed. Shape (paths, n).
    """

    law: str
    errors: FloatArray

    @cached_property
    def by_seed(self) -> FloatArray:
        """The mean over the paths of the error's logarithm, shape (n,): paths of any size count alike."""
        mean: FloatArray = np.log(self.errors).mean(axis=0)
        return mean

    @property
    def score(self) -> float:
        """The geometric mean over the paths of the error in the median repetition, in m."""
        return float(np.exp(np.median(self.by_seed)))

    @property
    def failed(self) -> float:
        """Share of the repetitions that failed along one path or more."""
        return float(np.mean(~np.isfinite(self.by_seed)))


@dataclass(frozen=True)
class Lead:
    """How far a law is ahead of another one.

    Attributes:
        law: The law with the smaller error.
        other: The other one.
        comparison: Logarithm of the other's error over its own, pair by pair of the same seeds.
        p_value: Corrected for all comparisons on the arm; None where nothing is drawn.
        shown: Whether it is ahead by a hundredth at least: by interval and corrected test, or along every path where
            nothing is drawn.
    """

    law: str
    other: str
    comparison: Comparison
    p_value: float | None
    shown: bool

    @property
    def factor(self) -> float:
        """The other's error over its own."""
        return float(np.exp(self.comparison.difference.median))

    @property
    def interval(self) -> tuple[float, float] | None:
        """The 95 % interval of the factor; None where nothing is drawn."""
        low, high = self.comparison.difference.low, self.comparison.difference.high
        return None if low is None or high is None else (float(np.exp(low)), float(np.exp(high)))


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


ALL_SEEDS = slice(None)


def cells(runs: Mapping[str, Run], arm: str, grid: str = "laws", seeds: slice = ALL_SEEDS) -> dict[str, Cell]:
    """Return what the laws did on an arm, by condition.

    Args:
        runs: The runs of the work.
        arm: Level of the axis arm.
        grid: How the runs' names begin: "laws", on Runge-Kutta, or "engine".
        seeds: Which repetitions count of runs that have several.

    Raises:
        RunnerError: if the laws of a cell differ in more than the law: in period, plant, path, limits or seeds.
        MissingError: if a run was not made.
    """
    grouped: dict[str, dict[str, dict[str, Run]]] = {}
    for one in found(runs, f"{grid}/{arm}/{{law}}/{{task}}/{{condition}}"):
        levels = one.levels
        grouped.setdefault(levels["condition"], {}).setdefault(levels["law"], {})[levels["task"]] = one.run
    ranked = {condition: _ranked(condition, by_law, seeds) for condition, by_law in grouped.items()}
    compared = {
        (condition, a.law, b.law): _compared(a, b)
        for condition, entered in ranked.items()
        for a, b in itertools.combinations(entered, 2)
    }
    tested = {key: each.p_value for key, each in compared.items() if each.p_value is not None}
    corrected = dict(zip(tested, holm(list(tested.values())).tolist(), strict=True))
    made = {}
    for condition, entered in ranked.items():
        leads = {
            (a.law, b.law): _lead(a, b, compared[condition, a.law, b.law], corrected.get((condition, a.law, b.law)))
            for a, b in itertools.combinations(entered, 2)
        }
        made[condition] = Cell(entered, leads)
    return made


def _ranked(condition: str, by_law: Mapping[str, Mapping[str, Run]], seeds: slice) -> list[Entry]:
    """Return the laws of a condition, the smallest error first."""
    first, *others = by_law
    for law, task in itertools.product(others, by_law[first]):
        _check_alike(condition, task, (first, by_law[first][task]), (law, by_law[law][task]))
    entered = []
    for law, by_task in by_law.items():
        errors = np.array([errors_of(run) for run in by_task.values()])
        entered.append(Entry(law, errors[:, seeds] if errors.shape[1] > 1 else errors))
    return sorted(entered, key=lambda each: each.score)


def errors_of(run: Run) -> FloatArray:
    """Return the error of a run in each repetition, in m, infinite where that failed, shape (n,)."""
    if _METRIC not in run.metrics:
        return np.full(run.config["repetitions"], np.inf)
    errors: FloatArray = np.nan_to_num(run.values(_METRIC), nan=np.inf, posinf=np.inf)
    return errors


def _check_alike(condition: str, task: str, one: tuple[str, Run], other: tuple[str, Run]) -> None:
    settings = [_setting(run) for _, run in (one, other)]
    apart = [key for key in dict.fromkeys([*settings[0], *settings[1]]) if settings[0].get(key) != settings[1].get(key)]
    if apart:
        key = apart[0]
        ours, theirs = (setting.get(key, "none") for setting in settings)
        raise RunnerError(
            f"{task}, {condition}: {key} is {ours} for {one[0]} and {theirs} for {other[0]}; laws are compared where "
            "nothing but they and their gains differ"
        )


def _setting(run: Run) -> dict[str, str]:
    """Return all that decides about a run but its law, with what the law carries; of the law the period stays."""
    part = simulated_part(run.config)
    period = {"controller.period": part["controller"]["period"]}
    return dict(entries({key: value for key, value in part.items() if key not in _LAW} | period))


def _compared(a: Entry, b: Entry) -> Comparison:
    """Return a comparison seed by seed, or of one seed where nothing is drawn and all give the same."""
    drawn = any(np.any(each.by_seed != each.by_seed[0]) for each in (a, b))
    seeds = slice(None) if drawn else slice(1)
    return _paired(a.by_seed[seeds].tobytes(), b.by_seed[seeds].tobytes())


@lru_cache(maxsize=2048)
def _paired(a: bytes, b: bytes) -> Comparison:
    """Return the comparison of two samples, which every table and finding asks for anew."""
    return compare_paired(np.frombuffer(a), np.frombuffer(b))


def _lead(a: Entry, b: Entry, comparison: Comparison, p_value: float | None) -> Lead:
    if p_value is not None:
        low = comparison.difference.low or 0.0
        return Lead(a.law, b.law, comparison, p_value, p_value < _SIGNIFICANCE and low > np.log(_LEAST))
    with np.errstate(invalid="ignore"):  # two runs that both failed
        return Lead(a.law, b.law, comparison, None, bool(np.all(b.errors > _LEAST * a.errors)))
