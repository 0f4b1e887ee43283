"""Results on one arm under one condition: errors along every path, and significant leads."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.papers.study.fit import difference, setting
from runner.papers.study.results import Runs, matching_runs
from runner.statistics import PairedComparison, compare_paired, holm, holm_levels
from runner.statistics.conclusion import ALPHA, SHARE
from runner.store import Run

_LEAST = 1.0 / (1.0 - SHARE)  # ratio of errors, above which a law leads


@dataclass(frozen=True)
class LawInCell:
    """One law in a cell.

    Attributes:
        law: Name of the law.
        errors: Its error with the gains of each tuning, along each path, in each repetition, in m; infinite where the
            run failed. Shape (tunings, paths, n).
    """

    law: str
    errors: FloatArray

    @cached_property
    def by_seed(self) -> FloatArray:
        """The mean over the paths of the error's logarithm, shape (tunings, n): paths of any size count alike."""
        mean: FloatArray = np.log(self.errors).mean(axis=1)
        return mean

    @cached_property
    def by_tuning(self) -> FloatArray:
        """The error in the median repetition, in m, of each tuning: the geometric mean over the paths."""
        medians: FloatArray = np.exp(np.median(self.by_seed, axis=1))
        return medians

    @cached_property
    def score(self) -> float:
        """The geometric mean of `by_tuning`, in m."""
        return float(np.exp(np.log(self.by_tuning).mean()))

    @property
    def failed(self) -> float:
        """Fraction of repetitions, of all tunings, that failed along one path or more."""
        return float(np.mean(~np.isfinite(self.by_seed)))


@dataclass(frozen=True)
class Lead:
    """Lead of a law over another one.

    Attributes:
        law: The law with the smaller error.
        other: The other one.
        factor: The other's error over its own.
        interval: From the lowest to the highest end of the intervals of the other's error over its own, on the same
            seeds, over all pairs of a tuning of the one and a tuning of the other, at the level at which its test was
            decided; None where nothing is drawn.
        p_value: The largest over these pairs, corrected for all comparisons on the arm; None if nothing is drawn.
        shown: Whether it may be called ahead with whichever tunings: by the corrected test and more than the share that
            an answer needs, or along every path where nothing is drawn.
    """

    law: str
    other: str
    factor: float
    interval: tuple[float, float] | None
    p_value: float | None
    shown: bool


def leads(ranked: Mapping[str, Sequence[LawInCell]]) -> dict[str, dict[tuple[str, str], Lead]]:
    """Return the lead of each law over each with a larger error, by both names, by condition.

    Args:
        ranked: The laws of each condition, the one with the smallest error first; all are corrected together.
    """
    pairs = {(name, a.law, b.law): (a, b) for name, laws in ranked.items() for a, b in itertools.combinations(laws, 2)}
    compared = {key: _compared(a, b) for key, (a, b) in pairs.items()}
    known = {key: [one.p_value for one in each if one.p_value is not None] for key, each in compared.items()}
    drawn = {key: max(own) for key, own in known.items() if own}
    p_values = list(drawn.values())
    corrected = dict(zip(drawn, zip(holm(p_values), holm_levels(p_values, ALPHA), strict=True), strict=True))
    made: dict[str, dict[tuple[str, str], Lead]] = {name: {} for name in ranked}
    for (name, law, other), (a, b) in pairs.items():
        key = (name, law, other)
        made[name][law, other] = _lead(a, b, compared[key], corrected.get(key))
    return made


def _compared(a: LawInCell, b: LawInCell) -> list[PairedComparison]:
    """Return a comparison seed by seed for each pair of tunings; of one seed where nothing is drawn."""
    drawn = any(np.any(each.by_seed != each.by_seed[:, :1]) for each in (a, b))
    seeds = slice(None) if drawn else slice(1)
    both = itertools.product(a.by_seed[:, seeds], b.by_seed[:, seeds])
    return [_paired(one.tobytes(), other.tobytes()) for one, other in both]


@lru_cache(maxsize=100_000)
def _paired(a: bytes, b: bytes) -> PairedComparison:
    """Return the comparison of two samples, which the same gains of two tunings, and halves of seeds, ask for again."""
    return compare_paired(np.frombuffer(a), np.frombuffer(b))


def _lead(
    a: LawInCell, b: LawInCell, compared: Sequence[PairedComparison], decided: tuple[float, float] | None
) -> Lead:
    with np.errstate(invalid="ignore"):  # two laws that both failed
        factor = float(np.float64(b.score) / a.score)
        if decided is None:
            along_all = b.errors.min(axis=0) > _LEAST * a.errors.max(axis=0)
            return Lead(a.law, b.law, factor, None, None, bool(np.all(along_all)))
    p_value, level = decided
    ends = [each.interval(level) or (-np.inf, np.inf) for each in compared]
    low, high = min(low for low, _ in ends), max(high for _, high in ends)
    has_values = all(each.n for each in compared)  # of both laws, in any draw
    shown = bool(has_values and p_value < ALPHA and min(each.difference for each in compared) > np.log(_LEAST))
    return Lead(a.law, b.law, factor, (float(np.exp(low)), float(np.exp(high))), float(p_value), shown)


UNTUNED = ("untuned",)
"""The gains that follow from the arm's bandwidth."""
ALL_SEEDS = slice(None)

ROUND = 4
"""The round that is judged of a motion that repeats."""

_ONE = ("1",)
_REPEATING = ("learned", "changed")
_OF_ALL = "rms_tracking_error"  # along a motion that does not repeat


@dataclass(frozen=True)
class BenchmarkCell:
    """An arm under a condition.

    Attributes:
        entries: The laws, the one with the smallest error first.
        leads: Lead of each over each with a larger error, by both names.
    """

    entries: Sequence[LawInCell]
    leads: Mapping[tuple[str, str], Lead]

    @property
    def best(self) -> LawInCell:
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

    def entry(self, law: str) -> LawInCell:
        """Return the result of a law."""
        return next(each for each in self.entries if each.law == law)


def tuned(runs: Runs) -> tuple[str, ...]:
    """Return the gains of the tunings that the runs are to have, in order: "1", "2" and so on."""
    return tuple(sorted(own for own in runs.levels("first", "gains") if own.isdecimal()))


def cells(
    runs: Runs,
    arm: str,
    grid: str = "first",
    seeds: slice = ALL_SEEDS,
    gains: Sequence[str] = (),
    tasks: Sequence[str] = (),
    after: int = ROUND,
) -> dict[str, BenchmarkCell]:
    """Return the results of the laws on an arm, by condition.

    Args:
        runs: The runs of the study.
        arm: Level of the axis arm.
        grid: How the runs' names begin: "first"; "engine", the same on another plant; "learned"; or "changed", where
            the change replaces the condition and there is one tuning.
        seeds: Which repetitions count of runs that have several.
        gains: Levels of the axis of gains that count; all tunings where none is named.
        tasks: Levels of the axis of tasks that count; all where none is named.
        after: The round that counts where the motion repeats.

    Raises:
        RunnerError: if the laws of a cell differ in more than the law: in period, plant, path, limits or seeds.
        MissingError: if a run was not made.
    """
    task = f"{{task={'|'.join(tasks)}}}" if tasks else "{task}"
    condition = "change" if grid == "changed" else "condition"
    gains = gains or (_ONE if grid == "changed" else tuned(runs))
    last = "" if grid == "changed" else f"/{{gains={'|'.join(gains)}}}"
    metric = f"{_OF_ALL}_period_{after}" if grid in _REPEATING else _OF_ALL
    errors = _errors(runs, f"{grid}/{arm}/{{law}}/{task}/{{{condition}}}{last}", condition, gains, metric)
    ranked = {name: _ranked(by_law, seeds) for name, by_law in errors.items()}
    ahead = leads(ranked)
    return {name: BenchmarkCell(entered, ahead[name]) for name, entered in ranked.items()}


def errors_of(run: Run, metric: str) -> FloatArray:
    """Return a metric of a run in each repetition, infinite where that failed, shape (n,)."""
    if metric not in run.metrics:
        return np.full(run.config["repetitions"], np.inf)
    errors: FloatArray = np.nan_to_num(run.values(metric), nan=np.inf, posinf=np.inf)
    return errors


def _ranked(by_law: Mapping[str, FloatArray], seeds: slice) -> list[LawInCell]:
    """Return the laws of a condition, the smallest error first."""
    entered = [LawInCell(law, errors[..., seeds] if errors.shape[-1] > 1 else errors) for law, errors in by_law.items()]
    return sorted(entered, key=lambda each: each.score)


def _errors(runs: Runs, pattern: str, axis: str, gains: Sequence[str], metric: str) -> dict[str, dict[str, FloatArray]]:
    """Return the errors of each law under each condition, shape (tunings, paths, n), of the runs of a pattern."""
    grouped: dict[str, dict[str, dict[str, dict[str, FloatArray]]]] = {}
    alike: dict[tuple[str, str], tuple[str, dict[str, str]]] = {}
    for one in matching_runs(runs, pattern):
        law, task, condition = (one.levels[each] for each in ("law", "task", axis))
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
