"""The search for gains: which values to try, and which of those that were tried are best.

All values of a round are known before it begins, so that its runs are made as those of any sweep are: on two cores or
on a cluster, and resumed. `runner tune` chooses each trial from those before it instead.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from runner.store import Run
from runner.works.tunings import Ranges, Tuning

ROUNDS = 2
_NARROWER = 0.25  # width of the second round's ranges, on the logarithmic scale, over that of the first one's


@dataclass(frozen=True)
class Tried:
    """A trial.

    Attributes:
        factors: Factor on the value that each key has otherwise.
        beyond: By how much the metric that is farthest beyond its bound is so, over the bound; 0 within all bounds,
            infinite where a repetition failed.
        error: The metric that is to be small; infinite likewise.
    """

    factors: Mapping[str, float]
    beyond: float
    error: float


def proposed(tuning: Tuning, seed: int, tried: Sequence[Tried]) -> list[dict[str, float]]:
    """Return the factors to try in a round: points of a Sobol sequence, spread evenly over the ranges.

    Of the first round the values as they are come first. The second round looks around the best trial, in ranges of a
    quarter of the width.

    Args:
        tuning: What is tuned.
        seed: Seed of the sequence's scrambling (Owen 1998).
        tried: The trials of the rounds before.
    """
    ranges = _around(tuning.ranges, best(tried).factors) if tried else tuning.ranges
    start: list[dict[str, float]] = [] if tried else [dict.fromkeys(ranges, 1.0)]
    if not ranges:
        return start
    low, high = np.log(np.array(list(ranges.values()))).T
    power = math.ceil(math.log2(tuning.trials))
    sequence = qmc.Sobol(len(ranges), scramble=True, seed=np.random.default_rng([seed, len(tried)]))
    points = np.exp(low + (high - low) * sequence.random_base2(power)[: tuning.trials])
    return [*start, *(dict(zip(ranges, point.tolist(), strict=True)) for point in points)]


def judged(tuning: Tuning, factors: Mapping[str, float], run: Run | None) -> Tried:
    """Return what came of a trial.

    Args:
        tuning: What is tuned.
        factors: What was tried.
        run: Its run; None where that was not made.
    """
    if run is None or run.status != "ok":
        return Tried(factors, math.inf, math.inf)
    beyond = [_median(run, metric) / bound - 1.0 for metric, bound in tuning.bounds.items()]
    return Tried(factors, max([0.0, *beyond]), _median(run, tuning.minimize))


def best(tried: Sequence[Tried]) -> Tried:
    """Return the trial with the smallest error of those within all bounds; else the one that is least beyond."""
    return min(tried, key=lambda each: (each.beyond, each.error))


def _median(run: Run, metric: str) -> float:
    """Return the median of a metric over the repetitions; infinite where there is none."""
    median = run.metrics[metric]["median"] if metric in run.metrics else None
    return math.inf if median is None else float(median)


def _around(ranges: Ranges, centre: Mapping[str, float]) -> Ranges:
    narrowed = {}
    for key, (low, high) in ranges.items():
        reach = (high / low) ** (_NARROWER / 2.0)
        narrowed[key] = (max(low, centre[key] / reach), min(high, centre[key] * reach))
    return narrowed
