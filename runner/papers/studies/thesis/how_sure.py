"""Robustness of the verdicts: claims judged by all seeds, by each seed, and by groups of seeds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.metrics.summary import over_repetitions
from runner.papers.reporting.published_claims import (
    FACTOR,
    PublishedClaim,
    Verdict,
    compared_with,
    load_claims,
    verdict_on,
)
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs, matching_runs
from runner.reporting.document import Curves, Panel, Series
from runner.reporting.figures import origin
from runner.reporting.words import PRESET
from runner.store import Run

DRAWN = 2000
"""Groups of seeds drawn with replacement."""
_SEED = 0  # of what draws them: the same for all claims, so that what one is compared with has the same seeds
_ENDS = (0.01, 0.99)
_RUNS = "sure/{figure}/{preset}/{repetitions}"
_BESIDE = 0.12  # of a claim's place, so that the bars of both presets are seen
_COLORS = {"as_reported": 1, "full_equations": 0}  # palette indices, as in all figures of the report


@dataclass(frozen=True)
class JudgedClaim:
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
    alone: Sequence[Verdict | None]
    drawn: Sequence[Verdict | None]
    own: float | None
    own_verdict: Verdict | None

    def otherwise(self, verdicts: Sequence[Verdict | None]) -> int:
        """Return the number of verdicts that differ from that of all seeds."""
        return sum(verdict != self.verdict for verdict in verdicts)

    def quantiles(self) -> FloatArray:
        """Return median, 1 % and 99 % quantile; infinite if that many seeds have no value, empty of a failed run."""
        return np.quantile(self.values, (0.5, *_ENDS), method="inverted_cdf") if self.values.size else self.values

    def number(self, what: Literal["alone", "drawn", "plant"]) -> float | None:
        """Return the verdicts of single seeds or of groups that differ, in per cent; None if none are given.

        With "plant", return by which factor, 1 or more, the study's own median and that of the seeds differ.
        """
        if what != "plant":
            verdicts = getattr(self, what)
            return 100.0 * self.otherwise(verdicts) / len(verdicts) if verdicts else None
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
) -> JudgedClaim:
    """Return a claim judged by seeds.

    Args:
        claim: The claim.
        claims: All claims of the study.
        seeds: The runs of many seeds, by the end of the experiment's name.
        own: The study's own runs, also by the end of the experiment's name.
        preset: The preset that both have.
    """

    def by(groups: NDArray[np.intp]) -> list[Verdict | None]:
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
    return JudgedClaim(
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


def judged(runs: Runs) -> list[JudgedClaim]:
    """Return every claim under every preset, judged by the seeds of the Runge-Kutta plant."""
    claims = load_claims("thesis")
    made = matching_runs(runs, _RUNS)
    given = []
    for preset in PRESET:
        seeds = {one.levels["figure"]: one.run for one in made if one.levels["preset"] == preset}
        own = {figure: runs[f"{figure}/{preset}"] for figure in seeds}
        given += [judge_by_seeds(claim, claims, seeds, own, preset) for claim in claims]
    return sorted(given, key=lambda each: each.claim.number)


def around_printed(runs: Runs, caption: str, given: Sequence[JudgedClaim]) -> Curves:
    """Return simulated values over what they are compared with, between the factors within which a claim matches."""
    numbers = list(dict.fromkeys(each.claim.number for each in given))
    series: list[Series] = []
    for side, (preset, words) in zip((-1, 1), PRESET.items(), strict=True):
        shown = [each for each in given if each.preset == preset and each.values.size and each.printed]
        ends = np.array([each.quantiles() / (each.printed or 1.0) for each in shown]).reshape(-1, 3)
        middle, low, high = np.where(np.isfinite(ends), ends, np.nan).T
        x = np.array([numbers.index(each.claim.number) for each in shown]) + _BESIDE * side
        series.append(Series(words, x, middle, "points", low, high, _COLORS[preset]))
    across = np.array([-0.5, len(numbers) - 0.5])
    limits = (("a claim matches in between", FACTOR), ("", 1.0 / FACTOR))
    series += [Series(name, across, np.full(2, factor), "dotted", color=7) for name, factor in limits]
    names = [str(each) for each in numbers]
    panel = Panel("", "claim", "simulated over printed", series, y_log=True, x_names=names)
    return Curves(caption, [panel], 1, origin(matching_runs(runs, _RUNS)[0].run))


def seeds(given: Sequence[JudgedClaim], words: str) -> Measured:
    """Return by how many seeds the claims are judged."""
    return Measured(words, max(each.values.size for each in given))


def most(
    given: Sequence[JudgedClaim],
    what: Literal["alone", "drawn", "plant"],
    words: str,
    claim: int = 0,
    preset: str = "",
    but: int = 0,
) -> Measured:
    """Return the largest of a number of claims.

    Args:
        given: The claims judged by seeds.
        what: `alone` or `drawn` for verdicts of single seeds, or of groups as large as the study's own run, that are
            others, in per cent; `plant` for the factor between the medians on the study's plant and on that of the
            seeds.
        words: What it is called.
        claim: The number of one claim; 0 for all.
        preset: One preset; "" for all.
        but: The number of a claim that is left out.
    """
    chosen = [each for each in given if claim in (0, each.claim.number) and preset in ("", each.preset)]
    values = [each.number(what) for each in chosen if each.claim.number != but]
    known = [value for value in values if value is not None]
    return Measured(words, max(known) if len(known) == len(values) else None, "1" if what == "plant" else "%")


def unanimous(given: Sequence[JudgedClaim], words: str) -> Measured:
    """Return of how many judgements every single seed says the same."""
    return Measured(words, sum(bool(each.alone) and not each.otherwise(each.alone) for each in given))


def other_by_plant(given: Sequence[JudgedClaim], words: str) -> Measured:
    """Return the number of the study's own verdicts that differ from those of the seeds."""
    return Measured(words, sum(each.verdict != each.own_verdict for each in given))


def mostly_moved_by_plant(given: Sequence[JudgedClaim], words: str) -> Measured:
    """Return the median of the factors between the medians on both plants."""
    known = [factor for factor in (each.number("plant") for each in given) if factor is not None]
    return Measured(words, float(np.median(known)) if len(known) == len(given) else None)
