"""Repetitions that show a difference of a given size in a sweep, or a probability of failing, counted from a pilot."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.errors import RunnerError
from runner.base.quantities import quantity
from runner.reporting.answers import Answer
from runner.reporting.metric_titles import title
from runner.reporting.sweep.question import find_answers
from runner.reporting.sweep.spec import find_failing
from runner.reporting.sweep.subject import Subject
from runner.reporting.table import Table, numbers
from runner.schema.bound import Bound
from runner.statistics.conclusion import ALPHA, SHARE, larger_median

_EXACT = "exact, because nothing is drawn"
PILOT = 8
"""Repetitions of a pilot."""


@dataclass(frozen=True)
class Needed:
    """Repetitions that show a difference in a metric, or a probability of failing.

    Attributes:
        name: Metric or bound in words.
        place: Condition or cell that needs most repetitions, such as "robot=macro", or "all".
        wanted: The difference or the probability, in words.
        repetitions: Their number; None if no number does, or if it cannot be estimated.
        ends: The numbers that both ends of the 95 % interval of the pilot's scatter need; None without it.
        reason: What the number follows from besides the scatter, or the reason why there is none; may be empty.
        metric: Name of the metric; empty for a bound.
    """

    name: str
    place: str
    wanted: str
    repetitions: int | None
    ends: tuple[int, int] | None = None
    reason: str = ""
    metric: str = ""

    @property
    def _rank(self) -> float:
        return math.inf if self.repetitions is None else self.repetitions


def check_share(share: float) -> None:
    """Check that a difference can be shown, as a share of the larger median.

    Raises:
        RunnerError: if it is not above 0.02 and at most 1.
    """
    if not SHARE < share <= 1.0:
        raise RunnerError(f"share: cannot be shown ({share!r}). Allowed: above {SHARE:g}, up to 1.")


def count_differences(subject: Subject, share: float) -> list[Needed]:
    """Return the repetitions of each metric that show a difference, under the condition that needs most.

    Args:
        subject: The pilot, a sweep with a few repetitions.
        share: The difference, as a share of the larger median, or of 1 for a metric that is a fraction.
    """
    repetitions = subject.measurements.repetitions
    found: dict[str, Needed] = {}
    for one in find_answers(subject):
        needed = _of_difference(one, share, repetitions)
        known = found.get(one.metric)
        found[one.metric] = needed if known is None else max(known, needed, key=lambda each: each._rank)
    return list(found.values())


def count_failures(subject: Subject, spec: Mapping[str, Bound], probability: float) -> list[Needed]:
    """Return the repetitions that distinguish the probability of failing each bound from another, in the worst cell.

    Args:
        subject: The pilot.
        spec: The bounds.
        probability: The probability.
    """
    from runner.statistics.proportion import count_share, needed_repetitions

    found = []
    for one in find_failing(subject, spec) if spec else ():
        cells = []
        for cell in np.flatnonzero(one.of).tolist():
            seen = count_share(int(one.failed[cell]), int(one.of[cell]))
            needed = 1 if one.exact[cell] else needed_repetitions(seen, probability)
            reason = _EXACT if one.exact[cell] else f"{seen.kept} of {seen.of} failed; if that share stays"
            place = subject.cell_name(cell) or "all"
            cells.append(Needed(one.name, place, f"{100.0 * probability:g} %", needed, None, reason))
        found += [max(cells, key=lambda each: each._rank)] if cells else []
    return found


def needed_table(found: Sequence[Needed]) -> Table:
    """Return a row for each metric and bound."""
    rows = [
        [
            one.name,
            one.place,
            one.wanted,
            "–" if one.repetitions is None else str(one.repetitions),
            "" if one.ends is None else f"{one.ends[0]} to {one.ends[1]}",
            one.reason,
        ]
        for one in found
    ]
    return Table("", ["", "hardest at", *numbers("shows", "repetitions", "95 % range"), ""], rows)


def _of_difference(one: Answer, share: float, repetitions: int) -> Needed:
    found = one.comparison
    size = share if "fraction" in one.metric else share * larger_median(found)

    def needed(count: int | None, ends: tuple[int, int] | None = None, reason: str = "") -> Needed:
        return Needed(title(one.metric), one.place, quantity(size, one.unit, 2), count, ends, reason, one.metric)

    if one.limit or one.is_lost:
        return needed(None, reason=one.word)
    if found.exact:
        return needed(1, reason=_EXACT)
    level = ALPHA / max(one.family, 1)
    pairs, ends = found.pairs_needed(size, level, one.least), found.range_needed(size, level, one.least)
    if size <= one.least:
        why = "integration error" if found.error == one.least else "2 %"
        return needed(None, reason=f"up to {quantity(one.least, one.unit, 2)} does not count: {why}")
    if pairs is None or ends is None:
        return needed(None, reason="pairs without a value, or too few of them")
    usable = int(np.isfinite(found.differences).sum()) / repetitions  # pairs of a repetition
    return needed(math.ceil(pairs / usable), (math.ceil(ends[0] / usable), math.ceil(ends[1] / usable)))
