"""Verdict on a comparison: "smaller", "larger", or the reason for neither, and its one set of numbers.

A difference is reported by the rule of `statistics.conclusion`, with p corrected by Holm's procedure for all
comparisons of its metric. Verdict, interval and p follow from one test. The interval has the level at which Holm's
procedure decided, so that it excludes zero exactly if the corrected p is below 5 %. If nothing is drawn, the difference
is exact and not tested. A torque at its limit is not compared.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from runner.base.quantities import ROUNDING, choose_unit, number, quantity, share_of_larger
from runner.caveats.rounding_growth import SENSITIVE
from runner.reporting.asked import EQUAL, AskedComparison
from runner.reporting.metric_titles import capital, title
from runner.reporting.table import Cell, Number
from runner.statistics import SMALLEST_SAMPLE, fewest_pairs, holm, holm_levels
from runner.statistics.conclusion import ALPHA, SHARE, conclusion_sign, least_difference

PAIRS = (
    "A pair is one draw of both: the same seed and repetition, cells that share a draw by their mean. Differences are "
    "Hodges-Lehmann estimates over the pairs, with the median of the larger side. At most "
    f"{100 * ALPHA:g} % of metrics without a difference get an answer (signed ranks, Holm); each interval has the "
    "level of its comparison."
)
"""Meaning of the numbers of a comparison, once for each page."""

EXPLAINED = (
    f"{PAIRS} Effect is the rank-biserial correlation: 1 with all pairs larger, -1 with all smaller. p of the "
    "signed-rank test is corrected for all comparisons of a metric. Each metric is a separate question: of equal "
    f"metrics one in twenty is shown by chance. An answer needs p below {ALPHA:g} and a difference above the plant's "
    f"error in it and above {100 * SHARE:g} % of the larger median, or {SHARE:g} of a fraction. Medians are of the "
    "compared draws: those in which neither has a value are left out."
)

CHOSEN = (
    "Trials are chosen by their own draws and may look better than they are. To compare one, run it and another one "
    "with another seed."
)
"""Note on the trials that a tuning chose: none is called the best."""

HEADER = ("difference", "interval", "n", "effect", "p")
"""Columns between the names of what is compared and the word."""

_SMALLEST = 1e-3  # p-value that is printed
_SHARES = (0.05, SHARE)  # differences, relative to the larger median, for which pairs are counted
_PLAIN = (1e-4, 1e5)  # sizes that are printed without a power of ten
_MOST_DIGITS = 5  # of a printed value


class PrintedNumbers(NamedTuple):
    """The numbers of a comparison as strings with one unit.

    Attributes:
        values: Median of the first and of the second.
        amount: Size of the difference.
        ends: Ends of the interval of the difference, second minus first; empty without one.
        share: The size in per cent of the larger median; empty for a fraction and without medians.
    """

    values: tuple[str, str]
    amount: str
    ends: str
    share: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer(AskedComparison):
    """A comparison, judged with the others of its metric.

    Attributes:
        p_value: Its p, corrected for the family; None without a test.
        level: The level at which it was decided.
        family: Number of tested comparisons of the metric.
        rank: 0 for the primary metric, 1 for its cost, 2 for all others.
        scale: Factor and unit in which all comparisons of the metric are printed.
    """

    p_value: float | None
    level: float
    family: int
    rank: int
    scale: tuple[float, str]

    @property
    def interval(self) -> tuple[float, float] | None:
        """The interval of the difference; None without a test and with too few pairs for its level."""
        return None if self.limit or self.comparison.exact else self.comparison.interval(self.level)

    @property
    def least(self) -> float:
        """The difference from which on it is an answer, in the metric's unit."""
        return least_difference(self.comparison, "fraction" in self.metric)

    @property
    def equal(self) -> bool:
        """True if all pairs are equal up to rounding, and their signs show no difference if rounding is not small."""
        return not (self.limit or self.is_lost) and (
            self.differs_at_most(EQUAL) or (self.within_rounding and not self.sign)
        )

    @property
    def sign(self) -> int:
        """-1 where the second may be called smaller, 1 where larger, 0 where neither may be said."""
        shown = self.p_value is not None and self.p_value < ALPHA
        return 0 if self.limit else conclusion_sign(self.comparison, shown, "fraction" in self.metric)

    @property
    def smaller(self) -> str:
        """The name of the smaller one; empty where none may be said."""
        return self.names[self.sign < 0] if self.sign else ""

    @property
    def is_answerable(self) -> bool:
        """True if the number of pairs can show a difference in the number of comparisons."""
        return bool(self.limit) or self.is_lost or self.comparison.exact or self.equal or self.interval is not None

    @property
    def fewest(self) -> int:
        """The fewest pairs that can show a difference in a family of this size."""
        return fewest_pairs(min(self.level, ALPHA / max(self.family, 1)))

    @property
    def word(self) -> str:
        """Relation of the second to the first, or the reason why none is shown."""
        found, size = self.comparison, abs(self.comparison.difference)
        if self.limit:
            return "at its limit"
        if self.is_lost:
            return "no value in either"
        if self.equal:
            return "equal up to rounding"
        if not found.exact and self.p_value is None:
            return f"too few pairs to say ({found.n} of {SMALLEST_SAMPLE})"
        if self.p_value is not None and self.p_value >= ALPHA:
            few = f"too few pairs for {self.family} comparisons ({found.n} of {self.fewest})"
            return "no difference shown" if self.interval else few
        if found.error is not None and size <= found.error:
            left = quantity(found.error, self.unit, 2) if np.isfinite(found.error) else "a run fails on a finer step"
            return f"below what the plant's step leaves ({left})"
        if size <= self.least:
            return f"less than {SHARE:g} apart" if "fraction" in self.metric else f"less than {100 * SHARE:g} % apart"
        return "smaller" if self.sign < 0 else "larger"

    @property
    def cells(self) -> list[str]:
        """The cells of a table: HEADER, then the word."""
        found, shown = self.comparison, self.printed
        if self.is_lost:
            return ["–", "–", "0", "–", "–", self.word]
        minus = "-" if found.difference < 0 else ""
        return [
            f"{minus}{shown.amount}" if np.isfinite(found.difference) else "beyond every number",
            "exact" if found.exact else shown.ends or "–",
            str(found.n),
            f"{found.effect:.2f}",
            "–" if self.p_value is None else _chance(self.p_value),
            self.word,
        ]

    @property
    def plain_cells(self) -> list[Cell]:
        """The cells of a table in SI units: HEADER, then the word."""
        found = self.comparison
        if self.is_lost:
            return [Number(None), Number(None), "0", "-", "-", self.word]
        return [
            Number(found.difference),
            "exact" if found.exact else Number(None, *(self.interval or ())),
            str(found.n),
            f"{found.effect:.2f}",
            "-" if self.p_value is None else f"{self.p_value:.2g}",
            self.word,
        ]

    @property
    def short_cells(self) -> list[str]:
        """The cells of a short table: median of the first, difference with its interval, and the answer."""
        found, shown = self.comparison, self.printed
        minus = "-" if found.difference < 0 else "+"
        if self.limit:
            return [shown.values[0], "–", f"not compared: {self.limit}"]
        if self.is_lost:
            return [shown.values[0], "–", self.word]
        difference = "0" if self.differs_at_most(EQUAL) else f"{minus}{shown.amount}"
        ends = f" ({shown.ends})" if shown.ends and difference != "0" else ""
        return [shown.values[0], f"{difference}{ends}", self.verdict]

    @property
    def verdict(self) -> str:
        """The answer in a few words, such as "computed_torque 24 % smaller", or the reason for none."""
        if not self.sign:
            return f"{self.word}{self._rounding() if self.equal else ''}"
        exactly = ", exactly" if self.comparison.exact else ""
        return f"{self.smaller} {f'{self.printed.share} ' if self.printed.share else ''}smaller{exactly}"

    def sentence(self, price: str = "") -> str:
        """Return in one sentence how both compare, and without an answer what the pairs can show.

        Args:
            price: What the smaller value costs, to follow it.
        """
        return f"{capital(title(self.metric))}: {self.clause(price)}"

    def clause(self, price: str = "") -> str:
        """Return the sentence without its metric; see `sentence`."""
        found, shown = self.comparison, self.printed
        first, second = self.full_names
        both = f"{first} ({shown.values[0]}) and {second}" + (f" ({shown.values[1]})" if found.exact else "")
        if self.limit:
            return f"{first} and {second} are not compared: {self.limit}."
        if self.is_lost:
            return f"{first} and {second} have no value in any draw."
        if self.equal:
            pairs = "" if found.exact else f" ({found.count})"
            return f"{both} are equal up to rounding{self._rounding()}{pairs}{self._empty()}."
        if not self.sign:
            if self.word == "no difference shown":
                return f"no difference is shown between {both}, difference {self._evidence()}.{self.power}"
            return f"{both}, {self.word}{', nothing is drawn' if found.exact else ''}{self._empty()}.{self.power}"
        one, other = (second, first) if self.sign < 0 else (first, second)
        small, large = shown.values[::-1] if self.sign < 0 else shown.values
        share = f"{shown.share} smaller" if shown.share else "smaller"
        if found.exact:
            return (
                f"{share} with {one} ({small}) than with {other} ({large}), exactly: nothing is drawn, "
                f"{self._error()}{self._empty()}{price}."
            )
        return f"{share} with {one} than with {other} ({large}): by {self._evidence()}{price}."

    @cached_property
    def printed(self) -> PrintedNumbers:
        """The numbers as strings."""
        found, size = self.comparison, abs(self.comparison.difference)
        share = "" if "fraction" in self.metric else share_of_larger(size, *sorted(found.medians))
        first, second = (self._quantity(one) if np.isfinite(one) else "never" for one in found.medians)
        amount = self._quantity(size) if np.isfinite(size) else "more than any number"
        return PrintedNumbers((first, second), amount, self._range(self.interval), share)

    @cached_property
    def _decimals(self) -> int:
        """Decimals: for two digits of the difference and its printed share, or without an answer of its interval."""
        found, (factor, _) = self.comparison, self.scale
        shown = [found.difference] if self.sign else [found.difference, *(self.interval or ())]
        size, most = (
            factor * max((abs(one) for one in some if np.isfinite(one)), default=0.0) for some in (shown, found.medians)
        )
        if self.differs_at_most(EQUAL) or not size:
            size = most / 10.0  # three digits of the median
        decimals = 1 - math.floor(math.log10(size)) if size > 0.0 else 0
        finest = max(0, _MOST_DIGITS - 1 - math.floor(math.log10(most))) if most > 0.0 else decimals
        first = max(0, min(decimals, finest))
        values = factor * abs(found.difference), *(factor * one for one in sorted(found.medians))
        whole = share_of_larger(*values)
        agree = (n for n in range(first, finest + 1) if share_of_larger(*(round(one, n) for one in values)) == whole)
        return next(agree, first) if self.sign and np.isfinite(values).all() else first

    def _number(self, value: float) -> str:
        if not math.isfinite(value):
            return "never"
        scaled, decimals = self.scale[0] * value, self._decimals
        plain = value == 0.0 or (_PLAIN[0] <= abs(scaled) < _PLAIN[1] and round(abs(scaled), decimals) > 0.0)
        return f"{scaled:.{decimals}f}" if plain else number(scaled, 2)

    def _quantity(self, value: float) -> str:
        return f"{self._number(value)} {self.scale[1]}".strip()

    def _range(self, ends: tuple[float, float] | None) -> str:
        if ends is None:
            return ""
        low, high = (self._quantity(end) if math.isfinite(end) else "" for end in ends)
        if low and high:
            return f"{self._number(ends[0])} to {high}"
        if low or high:
            return f"above {low}" if low else f"below {high}"
        return "beyond every number" if ends[0] == ends[1] else "unbounded"

    @property
    def power(self) -> str:
        """The smallest difference that these pairs can show, and how many would show less; empty with an answer.

        It follows from the scatter of the pairs' differences, and so from the correlation within pairs. No difference
        below the least one that counts can be shown.
        """
        found = self.comparison
        if self.sign or not self.is_tested or self.equal or (self.p_value is not None and self.p_value < ALPHA):
            return ""
        if self.interval is None:
            return f" At least {self.fewest} pairs are needed."
        shown, larger = found.smallest_shown(self.level), self.larger
        if not shown or not larger:
            return ""
        best = max(shown, self.least)
        text = f" {found.n} pairs can show {self._with_share(best)} at best"
        wanted = next((share * larger for share in _SHARES if self.least <= share * larger < best), self.least)
        count = found.pairs_needed(wanted, self.level) if wanted < best else None
        return f"{text}{f'; {number(float(count), 2)} would show {self._with_share(wanted)}' if count else ''}."

    @property
    def pairs_that_tell(self) -> int | None:
        """The number of pairs, more than these, that would show 5 % of the larger median, else 2 %; None if unknown."""
        for wanted in (max(share * self.larger, self.least) for share in _SHARES):
            count = self.comparison.pairs_needed(wanted, self.level)
            if count is not None and count > self.comparison.n:
                return count
        return None

    def _with_share(self, size: float) -> str:
        known = self.larger > ROUNDING and "fraction" not in self.metric
        share = f"{number(100.0 * size / self.larger, 2)} % " if known else ""
        factor, unit = self.scale
        text = f"{number(factor * size, 2, plain=_PLAIN[0])} {unit}".strip()
        return f"{share}({text})" if share else text

    def _rounding(self) -> str:
        """Return by how much rounding changes the metric, to follow a phrase; empty if that is known to be small."""
        share = self.comparison.rounding
        return f", which changes it by {number(100.0 * share, 2)} %" if share > SENSITIVE else ""

    def _empty(self) -> str:
        """Return in how many repetitions neither has a value, to follow a phrase; empty if there are none."""
        return f", {self.comparison.empty}" if self.comparison.empty.repetitions else ""

    def _error(self) -> str:
        error, (factor, unit) = self.comparison.error, self.scale
        if error is None:
            return "integration error unknown"
        return f"integration error {number(factor * error, 2, plain=_PLAIN[0])} {unit}".strip()

    def _evidence(self) -> str:
        """Return the difference in pairs with its interval and number of pairs as a phrase."""
        found, ends = self.comparison, self.interval
        if self.sign < 0 and ends:
            ends = -ends[1], -ends[0]
        minus = "-" if not self.sign and found.difference < 0 else ""
        parts = [self._range(ends), found.count]
        parts += [f"no value in {a} and {b} of {found.n} draws" for a, b in [found.lost] if a or b]
        parts += [str(found.empty)]
        parts += ["integration error unknown"] if self.sign and found.error is None else []
        return f"{minus}{self.printed.amount} in pairs ({', '.join(filter(None, parts))})"


def judge(asked: Sequence[AskedComparison], first: Sequence[str]) -> list[Answer]:
    """Return the answers to a question, in the order of its comparisons; those of a metric are one family.

    Args:
        asked: All comparisons that the question makes.
        first: Metrics of the first screen: the task's primary one, then its cost.
    """
    answers: dict[int, Answer] = {}
    places: dict[str, list[int]] = {}
    for place, one in enumerate(asked):
        places.setdefault(one.metric, []).append(place)
    for metric, some in places.items():
        rank = first.index(metric) if metric in first[:2] else 2
        family = [place for place in some if asked[place].is_tested]
        tested = [place for place in family if asked[place].comparison.p_value is not None]
        p_values = [asked[place].comparison.p_value or 0.0 for place in tested]
        corrected = dict(zip(tested, holm(p_values).tolist(), strict=True))
        levels = dict(zip(tested, holm_levels(p_values, ALPHA).tolist(), strict=True))
        sizes = [abs(one) for place in some for one in asked[place].comparison.medians if np.isfinite(one)]
        scale = choose_unit(max(sizes, default=None), asked[some[0]].unit)
        for place in some:
            one, level = asked[place], levels.get(place, ALPHA / max(len(family), 1))
            judged = {
                "p_value": corrected.get(place),
                "level": level,
                "family": len(family),
                "rank": rank,
                "scale": scale,
            }
            answers[place] = Answer(one.metric, one.unit, one.comparison, one.pairs, one.limit, **judged)
    return [answers[place] for place in range(len(asked))]


def _chance(p_value: float) -> str:
    return f"{p_value:.2g}" if p_value >= _SMALLEST else f"< {_SMALLEST:g}"
