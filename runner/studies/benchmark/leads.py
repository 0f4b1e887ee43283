"""Lead of one controller over another: by seeds, and by each pair of tunings."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from runner.base.arrays import FloatArray
from runner.reporting.answers import ALPHA, SHARE
from runner.statistics import Comparison, compare_paired, holm, holm_levels

_LEAST = 1.0 / (1.0 - SHARE)  # ratio of errors; less is no lead


@dataclass(frozen=True)
class Entry:
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

    @property
    def by_tuning(self) -> FloatArray:
        """The error in the median repetition, in m, of each tuning: the geometric mean over the paths."""
        medians: FloatArray = np.exp(np.median(self.by_seed, axis=1))
        return medians

    @property
    def score(self) -> float:
        """The geometric mean of `by_tuning`, in m."""
        return float(np.exp(np.log(self.by_tuning).mean()))

    @property
    def failed(self) -> float:
        """Share of the repetitions, of all tunings, that failed along one path or more."""
        return float(np.mean(~np.isfinite(self.by_seed)))


@dataclass(frozen=True)
class Lead:
    """How far a law is ahead of another one.

    Attributes:
        law: The law with the smaller error.
        other: The other one.
        factor: The other's error over its own.
        interval: From the lowest to the highest end of the intervals of the other's error over its own, on the same
            seeds, over all pairs of a tuning of the one and a tuning of the other, at the level at which its test was
            decided; None where nothing is drawn.
        p_value: The largest over these pairs, corrected for all comparisons on the arm; None likewise.
        shown: Whether it may be called ahead with whichever tunings: by the corrected test and more than the share that
            an answer needs, or along every path where nothing is drawn.
    """

    law: str
    other: str
    factor: float
    interval: tuple[float, float] | None
    p_value: float | None
    shown: bool


def leads(ranked: Mapping[str, Sequence[Entry]]) -> dict[str, dict[tuple[str, str], Lead]]:
    """Return the lead of each law on each that stands behind it, by both names, by condition.

    Args:
        ranked: The laws of each condition, the one with the smallest error first; all that is corrected together.
    """
    pairs = {(name, a.law, b.law): (a, b) for name, laws in ranked.items() for a, b in itertools.combinations(laws, 2)}
    compared = {key: _compared(a, b) for key, (a, b) in pairs.items()}
    drawn = {key: max(p_values) for key, each in compared.items() if (p_values := _p_values(each))}
    p_values = list(drawn.values())
    corrected = dict(zip(drawn, zip(holm(p_values), holm_levels(p_values, ALPHA), strict=True), strict=True))
    made: dict[str, dict[tuple[str, str], Lead]] = {name: {} for name in ranked}
    for (name, law, other), (a, b) in pairs.items():
        key = (name, law, other)
        made[name][law, other] = _lead(a, b, compared[key], corrected.get(key))
    return made


def _compared(a: Entry, b: Entry) -> list[Comparison]:
    """Return a comparison seed by seed for each pair of tunings; of one seed where nothing is drawn."""
    drawn = any(np.any(each.by_seed != each.by_seed[:, :1]) for each in (a, b))
    seeds = slice(None) if drawn else slice(1)
    both = itertools.product(a.by_seed[:, seeds], b.by_seed[:, seeds])
    return [_paired(one.tobytes(), other.tobytes()) for one, other in both]


@lru_cache(maxsize=100_000)
def _paired(a: bytes, b: bytes) -> Comparison:
    """Return the comparison of two samples, which the same gains of two tunings, and halves of seeds, ask for again."""
    return compare_paired(np.frombuffer(a), np.frombuffer(b))


def _p_values(compared: Sequence[Comparison]) -> list[float]:
    return [each.p_value for each in compared if each.p_value is not None]


def _lead(a: Entry, b: Entry, compared: Sequence[Comparison], decided: tuple[float, float] | None) -> Lead:
    with np.errstate(invalid="ignore"):  # two laws that both failed
        factor = float(np.float64(b.score) / a.score)
        if decided is None:
            along_all = b.errors.min(axis=0) > _LEAST * a.errors.max(axis=0)
            return Lead(a.law, b.law, factor, None, None, bool(np.all(along_all)))
    p_value, level = decided
    ends = [each.interval(level) or (-np.inf, np.inf) for each in compared]
    low, high = min(low for low, _ in ends), max(high for _, high in ends)
    shown = bool(p_value < ALPHA and min(each.difference for each in compared) > np.log(_LEAST))
    return Lead(a.law, b.law, factor, (float(np.exp(low)), float(np.exp(high))), float(p_value), shown)
