"""Words for variations of a question: whether its answer holds, vanishes or is reversed when one choice is changed.

The question is whether B has a smaller or larger metric than A. Its answer on fresh seeds is the asked effect. Every
variation is a paired comparison of A and B with one choice changed. The rules are those of docs/statistics.md; the
first one that applies gives the word.

Variations are tested together by Holm's procedure, both directions at once. Those that are not shown go on with more
pairs, at most LOOKS times, with an equal share of the level for each look. Hypotheses that are decided leave the
family: without a false rejection so far, all true hypotheses are still in it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from runner.base.quantities import ROUNDING
from runner.statistics.conclusion import ALPHA, SHARE, conclusion_sign, larger_median
from runner.statistics.paired import PairedComparison, SignedRanks, fewest_pairs, holm_levels

Word = Literal[
    "cannot be asked", "neither works", "only one works", "reversed", "vanishes", "holds, weaker", "holds", "appears",
    "does not appear", "not shown",
]  # fmt: skip
"""Words of a variation, in the order of their rules; "appears" and "does not appear" if the asked answer is none."""

TOLD: Sequence[Word] = ("reversed", "vanishes", "holds, weaker", "holds", "appears", "does not appear")
"""Words that pairs decide."""

LOOKS = 3
"""Numbers of pairs at which the variations are tested; each look has an equal share of the level."""

FEWEST = 12
"""Fewest pairs of the first look."""

_QUARTER, _HALF = 0.25, 0.5  # of the asked effect: bounds of "vanishes" and "holds, weaker"
_MOST_BAD = 0.5  # share of the draws with a failure, up to which a side works


@dataclass(frozen=True)
class TriedVariation:
    """A variation of the question, as simulated.

    Attributes:
        comparison: B against A on the same draws; None if there is none.
        reason: Reason why the question cannot be asked; empty if it can.
        lost: Share of the draws in which A, and in which B, fails or does not follow the motion.
        spoilt: Share of the draws in which A, and in which B, fails, does not follow, is saturated or breaks its spec.
    """

    comparison: PairedComparison | None
    reason: str = ""
    lost: tuple[float, float] = (0.0, 0.0)
    spoilt: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class JudgedVariation:
    """A variation with its word.

    Attributes:
        word: The word.
        effect: The difference of B from A relative to the scale; None without one.
        low: Lower end of its interval, at the level at which it was decided; None without one.
        high: Upper end.
        pairs: Number of pairs.
        works: 0 if only A works, 1 if only B works; None otherwise.
        needed: Number of pairs that would tell; None if they decide, or if the number is unknown.
        log_ratio: Logarithm of the ratio B / A with its interval, for a picture; None if it is unknown.
    """

    word: Word
    effect: float | None = None
    low: float | None = None
    high: float | None = None
    pairs: int = 0
    works: int | None = None
    needed: int | None = None
    log_ratio: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class AskedEffect:
    """The asked effect: the answer of the question on fresh seeds.

    Attributes:
        sign: -1 if B is smaller, 1 if it is larger, 0 if no difference was shown.
        size: The difference relative to the scale.
        scale: Value that all differences are relative to; None for the larger median of each variation.
        is_fraction: True for a metric that is a fraction, whose differences are not relative.
    """

    sign: int
    size: float
    scale: float | None = None
    is_fraction: bool = False

    def of(self, found: PairedComparison) -> float:
        """Return the scale of a comparison."""
        return 1.0 if self.is_fraction else self.scale or max(larger_median(found), ROUNDING)

    @property
    def margin(self) -> float:
        """The relative difference up to which the answer vanishes: 2 %, or a quarter of the asked effect if larger."""
        return max(SHARE, _QUARTER * abs(self.size)) if self.sign else SHARE


def first_pairs(variations: int) -> int:
    """Return the number of pairs of the first look at some variations, which can decide each of them."""
    return max(FEWEST, fewest_pairs(ALPHA / LOOKS / max(variations, 1)))


def pairs_of_looks(first: int) -> list[int]:
    """Return the number of pairs of each look: those of the first one, twice and four times as many."""
    return [first << look for look in range(LOOKS)]


Ask = Callable[[Sequence[int], int], Sequence[TriedVariation]]
"""Function that simulates some variations, by their numbers, with a number of pairs."""


def judge_in_looks(ask: Ask, variations: int, asked: AskedEffect) -> list[JudgedVariation]:
    """Return the words of all variations; those that are not shown go on with more pairs.

    Args:
        ask: Function that simulates some variations; it may return fewer than asked for, then the rest ends here.
        variations: Number of variations.
        asked: The asked effect.
    """
    words: dict[int, JudgedVariation] = {}
    left = list(range(variations))
    for pairs in pairs_of_looks(first_pairs(variations)):
        tried = ask(left, pairs)
        words |= dict(zip(left, judge(tried, asked), strict=False))
        left = [place for place in left[: len(tried)] if words[place].word == "not shown"]
        if not left:
            break
    return [words[place] for place in sorted(words)]


def judge(tried: Sequence[TriedVariation], asked: AskedEffect, level: float = ALPHA / LOOKS) -> list[JudgedVariation]:
    """Return the word of each variation of a family at one look.

    Args:
        tried: The variations that no earlier look has decided.
        asked: The asked effect.
        level: Probability of one or more false rejections in this look.
    """
    words = [_without_test(one) for one in tried]
    tested = [
        place
        for place, one in enumerate(tried)
        if words[place] is None and one.comparison is not None and not one.comparison.exact
    ]
    p_values = [1.0 if (p := _compared(tried[place]).p_value) is None else p for place in tested]
    levels = dict(zip(tested, zip(p_values, holm_levels(p_values, level).tolist(), strict=True), strict=True))
    found = []
    for place, (one, judged) in enumerate(zip(tried, words, strict=True)):
        p_value, own = levels.get(place, (1.0, level))
        found.append(judged or _judge_one(_compared(one), asked, p_value < own, own))
    return found


def came_back(found: PairedComparison, stored: int, level: float, is_fraction: bool = False) -> int | None:
    """Return the sign of the asked case on fresh seeds if the stored answer comes back; None if it does not.

    Args:
        found: The comparison on fresh seeds.
        stored: Sign of the stored answer; 0 if it was "no difference".
        level: Level of this one test.
        is_fraction: True for a metric that is a fraction.
    """
    p_value = found.p_value
    sign = conclusion_sign(found, p_value is not None and p_value < level, is_fraction)
    return sign if sign == stored else None


def _compared(one: TriedVariation) -> PairedComparison:
    if one.comparison is None:
        raise ValueError("a variation without a comparison has no test")
    return one.comparison


def _without_test(one: TriedVariation) -> JudgedVariation | None:
    """Return the word of a variation that needs no test; None if it needs one."""
    pairs = one.comparison.n if one.comparison else 0
    if one.reason:
        return JudgedVariation("cannot be asked")
    if min(one.spoilt) > _MOST_BAD:
        return JudgedVariation("neither works", pairs=pairs)
    if (one.lost[0] > _MOST_BAD) != (one.lost[1] > _MOST_BAD):
        return JudgedVariation("only one works", pairs=pairs, works=int(one.lost[0] > _MOST_BAD))
    if one.comparison is None:
        return JudgedVariation("cannot be asked")
    return None


def _judge_one(found: PairedComparison, asked: AskedEffect, is_shown: bool, level: float) -> JudgedVariation:
    scale = asked.of(found)
    size = found.difference / scale
    ends = (found.difference, found.difference) if found.exact else found.interval(level)
    low, high = (None, None) if ends is None else (ends[0] / scale, ends[1] / scale)
    counts = asked.scale is None or abs(size) > SHARE  # 2 % of the scale that all variations share
    sign = conclusion_sign(found, is_shown, asked.is_fraction) if counts else 0
    word = _word(sign, low, high, asked)
    needed = None
    if word == "not shown" and not found.exact:
        needed = found.pairs_needed(max(abs(size), asked.margin) * scale, level)
        needed = None if needed is None else max(needed, found.n + 1)
    return JudgedVariation(word, size, low, high, found.n, needed=needed, log_ratio=_log_ratio(found, level))


def _word(sign: int, low: float | None, high: float | None, asked: AskedEffect) -> Word:
    """Return the word of a sign and the ends of an interval, both relative to the scale."""
    within = low is not None and high is not None and -asked.margin <= low and high <= asked.margin
    if not asked.sign:
        return "appears" if sign else "does not appear" if within else "not shown"
    if sign == -asked.sign:
        return "reversed"
    if within:
        return "vanishes"
    if sign and low is not None and high is not None:
        farthest = max(asked.sign * low, asked.sign * high)
        return "holds, weaker" if farthest < _HALF * abs(asked.size) else "holds"
    return "holds" if sign else "not shown"


def _log_ratio(found: PairedComparison, level: float) -> tuple[float, float, float] | None:
    """Return the logarithm of the ratio B / A with its interval; None if a value is not positive or pairs are few."""
    both = np.stack([found.a, found.b])
    if found.exact or not ((both > 0.0) & np.isfinite(both)).all():
        return None
    ranks = SignedRanks(np.log(found.b / found.a))
    ends = ranks.interval(level)
    return None if ends is None else (ranks.estimate, *ends)
