"""Robustness of the verdicts: tables, a figure and numbers of the claims over many seeds."""

from collections.abc import Sequence

import numpy as np

from runner.reporting.document import Curves, Panel, Series
from runner.reporting.figures import origin
from runner.reporting.published_claims import FACTOR, load_claims
from runner.reporting.sweep.effects import at_texts
from runner.reporting.words import PRESET
from runner.studies.thesis.judged import Judged, judge_by_seeds
from runner.study.measured import Measured
from runner.study.results import Runs, found

_RUNS = "sure/{figure}/{preset}/{repetitions}"
_BESIDE = 0.12  # of a claim's place, so that the bars of both presets are seen
_COLORS = {"as_reported": 1, "full_equations": 0}  # palette indices, as in all figures of the report


def judged(runs: Runs) -> list[Judged]:
    """Return every claim under every preset, judged by the seeds of the Runge-Kutta plant."""
    claims = load_claims("thesis")
    made = found(runs, _RUNS)
    given = []
    for preset in PRESET:
        seeds = {one.levels["figure"]: one.run for one in made if one.levels["preset"] == preset}
        own = {figure: runs[f"{figure}/{preset}"] for figure in seeds}
        given += [judge_by_seeds(claim, claims, seeds, own, preset) for claim in claims]
    return sorted(given, key=lambda each: each.claim.number)


def around_printed(runs: Runs, caption: str, given: Sequence[Judged]) -> Curves:
    """Return simulated values over what they are compared with, between the factors within which a claim matches."""
    numbers = list(dict.fromkeys(each.claim.number for each in given))
    series: list[Series] = []
    for side, (preset, words) in zip((-1, 1), PRESET.items(), strict=True):
        shown = [each for each in given if each.preset == preset and each.values.size and each.printed]
        ends = np.array([each.quantiles() / (each.printed or 1.0) for each in shown]).reshape(-1, 3)
        middle, low, high = np.where(np.isfinite(ends), ends, np.nan).T
        x = np.array([numbers.index(each.claim.number) for each in shown]) + _BESIDE * side
        series += at_texts(Series(words, x, middle, "points", low, high, _COLORS[preset]))
    across = np.array([-0.5, len(numbers) - 0.5])
    limits = (("a claim matches in between", FACTOR), ("", 1.0 / FACTOR))
    series += [Series(name, across, np.full(2, factor), "dotted", color=7) for name, factor in limits]
    names = [str(each) for each in numbers]
    panel = Panel("", "claim", "simulated over printed", series, y_log=True, x_names=names)
    return Curves(caption, [panel], 1, origin(found(runs, _RUNS)[0].run))


def seeds(given: Sequence[Judged], words: str) -> Measured:
    """Return by how many seeds the claims are judged."""
    return Measured(words, max(each.values.size for each in given))


def of_one_seed(given: Sequence[Judged], claim: int, preset: str, words: str) -> Measured:
    """Return the fraction of single seeds that would judge a claim otherwise, in per cent."""
    each = _find(given, claim, preset)
    return Measured(words, each.share_otherwise(each.alone), "%")


def of_groups(given: Sequence[Judged], claim: int, preset: str, words: str) -> Measured:
    """Return the fraction of judgements by as many seeds as the study's that would differ, in per cent."""
    each = _find(given, claim, preset)
    return Measured(words, each.share_otherwise(each.drawn), "%")


def most_of_groups(given: Sequence[Judged], words: str, but: int = 0) -> Measured:
    """Return the largest of these shares of all claims but one."""
    return _largest(words, "%", [each.share_otherwise(each.drawn) for each in given if each.claim.number != but])


def unanimous(given: Sequence[Judged], words: str) -> Measured:
    """Return of how many judgements every seed alone says the same."""
    return Measured(words, sum(bool(each.alone) and not each.otherwise(each.alone) for each in given))


def other_by_plant(given: Sequence[Judged], words: str) -> Measured:
    """Return the number of the study's own verdicts that differ from those of the seeds."""
    return Measured(words, sum(each.verdict != each.own_verdict for each in given))


def moved_by_plant(given: Sequence[Judged], words: str, claim: int = 0, preset: str = "") -> Measured:
    """Return by which factor the study's own median and that of the seeds differ: of one claim, or the most of all."""
    chosen = [_find(given, claim, preset)] if claim else given
    return _largest(words, "1", [each.moved_by_plant() for each in chosen])


def mostly_moved_by_plant(given: Sequence[Judged], words: str) -> Measured:
    """Return the median of these factors."""
    known = [factor for factor in (each.moved_by_plant() for each in given) if factor is not None]
    return Measured(words, float(np.median(known)) if len(known) == len(given) else None)


def _find(given: Sequence[Judged], claim: int, preset: str) -> Judged:
    return next(each for each in given if (each.claim.number, each.preset) == (claim, preset))


def _largest(words: str, unit: str, values: Sequence[float | None]) -> Measured:
    known = [value for value in values if value is not None]
    return Measured(words, max(known) if len(known) == len(values) else None, unit)
