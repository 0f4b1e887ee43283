"""Verdicts on a claim by all seeds, by each seed, and by groups of seeds as large as the run of the study."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.metrics.summary import over_repetitions
from runner.reporting.published_claims import PublishedClaim, Verdict, compared_with, verdict_on
from runner.store import Run

DRAWN = 2000
"""Groups of seeds drawn with replacement."""
_SEED = 0  # of what draws them: the same for all claims, so that what one is compared with has the same seeds
_ENDS = (0.01, 0.99)
_Places = NDArray[np.intp]
_Verdicts = Sequence[Verdict | None]


@dataclass(frozen=True)
class Judged:
    """A claim under one preset; of a run that failed without it has no value and no verdicts.

    Attributes:
        claim: The claim.
        preset: The preset.
        values: Simulated value of each seed, shape (seeds,); infinite where it has none.
        printed: What the median of all seeds is compared with; None where there is nothing.
        verdict: Verdict on that median.
        alone: Verdict on each single seed.
        drawn: Verdicts on the medians of groups that are as large as the study's own run, drawn with replacement.
        own: Median of the study's own run, on the plant by which its claims are judged.
        own_verdict: Verdict on that.
    """

    claim: PublishedClaim
    preset: str
    values: FloatArray
    printed: float | None
    verdict: Verdict | None
    alone: _Verdicts
    drawn: _Verdicts
    own: float | None
    own_verdict: Verdict | None

    def otherwise(self, verdicts: _Verdicts) -> int:
        """Return the number of verdicts that differ from that of all seeds."""
        return sum(verdict != self.verdict for verdict in verdicts)

    def share_otherwise(self, verdicts: _Verdicts) -> float | None:
        """Return the differing verdicts in per cent; None if none are given."""
        return 100.0 * self.otherwise(verdicts) / len(verdicts) if verdicts else None

    def quantiles(self) -> FloatArray:
        """Return median, 1 % and 99 % quantile; infinite where so many seeds have no value, empty of a failed run."""
        return np.quantile(self.values, (0.5, *_ENDS), method="inverted_cdf") if self.values.size else self.values

    def moved_by_plant(self) -> float | None:
        """Return by which factor, 1 or more, the study's own median and that of the seeds differ."""
        if self.own is None or not self.values.size or not np.isfinite(self.quantiles()[0]):
            return None
        ratio = self.own / float(self.quantiles()[0])
        return max(ratio, 1.0 / ratio)


def judge_by_seeds(
    claim: PublishedClaim,
    claims: Sequence[PublishedClaim],
    seeds: Mapping[str, Run],
    own: Mapping[str, Run],
    preset: str,
) -> Judged:
    """Return a claim judged by seeds.

    Args:
        claim: The claim.
        claims: All claims of the study.
        seeds: The runs of many seeds, by the end of the experiment's name.
        own: The study's own runs, also by the end of the experiment's name.
        preset: The preset that both have.
    """

    def by(groups: _Places) -> list[Verdict | None]:
        @lru_cache(maxsize=8)
        def medians(run: str, metric: str) -> list[float]:
            values = _values(seeds[run], metric)
            return over_repetitions(values[groups])[:, 0].tolist() if values.size else [np.nan] * len(groups)

        def simulated(group: int, *key: str) -> float | None:
            value = medians(*key)[group]
            return None if np.isnan(value) else value

        places = range(len(groups) if groups.size else 0)
        return [verdict_on(claim, claims, lambda *key, at=at: simulated(at, *key)) for at in places]

    def of_study(run: str, metric: str) -> float | None:
        return own[run].median(metric)

    def of_seeds(run: str, metric: str) -> float | None:
        return seeds[run].median(metric)

    run, metric = claim.simulated_by
    values = _values(seeds[run], metric)
    count = values.size
    size = int(own[run].config["repetitions"])
    every = np.arange(count)
    drawn = np.random.default_rng(_SEED).integers(0, count, (DRAWN, size)) if count else every
    return Judged(
        claim=claim,
        preset=preset,
        values=np.where(np.isnan(values), np.inf, values),
        printed=compared_with(claim, of_seeds),
        verdict=verdict_on(claim, claims, of_seeds) if count else None,
        alone=by(every[:, None]),
        drawn=by(drawn),
        own=of_study(run, metric),
        own_verdict=verdict_on(claim, claims, of_study),
    )


def _values(run: Run, metric: str) -> FloatArray:
    """Return a metric's value in each repetition of a run, NaN for none; nothing where the run has no metrics."""
    return run.values(metric) if run.metrics else np.zeros(0)
