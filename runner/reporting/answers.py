"""Verdict on a comparison: "smaller", "larger", or the reason for neither.

A difference is reported if its p-value, corrected by Holm's procedure for all comparisons of its family, is below
5 %. It must also exceed the integration error in it, and 2 % of the larger of the two medians (0.02 of a fraction).
Verdict, interval and p follow from one test. The interval has the level at which Holm's procedure decided, so that it
excludes zero exactly if the corrected p is below 5 %.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.quantities import ROUNDING, choose_unit, number, quantity, with_ends
from runner.metrics.rounding import SENSITIVE
from runner.reporting.comparison.pairs import Pairs, compare, label_text
from runner.reporting.metric_titles import capital, title
from runner.reporting.table import Cell, Column, Number, numbers
from runner.statistics import SMALLEST_SAMPLE, Comparison, fewest_pairs, holm, holm_levels

ALPHA = 0.05
"""Probability of one or more false differences in a family of comparisons."""

SHARE = 0.02
"""Share of the larger median, or a fraction itself, up to which a difference does not count."""

EXPLAINED = (
    "Both have the same seeds and are compared draw by draw, cells that share a draw by their mean: the Hodges-Lehmann "
    "estimate of the difference, its interval from n pairs, the effect (rank-biserial correlation: 1 with all pairs "
    "larger, -1 with all smaller), and p of the signed-rank test. Each axis, or pair of runs or sweeps, asks a "
    "separate question. Its comparisons in the first metric are one family, those in the other metrics of the first "
    "screen another, all others a third: p is corrected within the family (Holm), and the interval has the level at "
    f"which it was decided. Smaller or larger is said where p is below {ALPHA:g} and the difference above the plant's "
    f"error in it and above {100 * SHARE:g} % of the larger median, or {SHARE:g} of a fraction."
)

CHOSEN = (
    "Trials are chosen by their own draws and may look better than they are. To compare one, run it and another one "
    "with another seed."
)
"""Note on the trials that a tuning chose: none is called the best."""

HEADER = ("difference", "interval", "n", "effect", "p")
"""Columns between the names of what is compared and the word."""

_SMALLEST = 1e-3  # p-value that is printed
_EQUAL = 1e-9  # largest difference of a pair, relative to the larger median, that is rounding
_TIMES = 3.0  # ratio of the medians from which it is given instead of the difference in per cent
_SHARES = (0.05, SHARE)  # differences, relative to the larger median, for which pairs are counted
_MOST_TURNS, _MOST_SENTENCES = 4, 6


@dataclass(frozen=True, eq=False)
class Asked:
    """A comparison in one metric.

    Attributes:
        metric: Name of the metric.
        unit: Its unit.
        comparison: The second against the first, draw by draw.
        pairs: The compared cells.
    """

    metric: str
    unit: str
    comparison: Comparison
    pairs: Pairs | None = None

    @property
    def at(self) -> Mapping[str, str]:
        """The levels that two levels are compared within, or the label of the only pair of cells."""
        return self.pairs.at if self.pairs else {}

    @property
    def place(self) -> str:
        """These levels as a string, such as "robot=macro", or "all"."""
        return label_text(self.at) if self.at else "all"

    @property
    def within_rounding(self) -> bool:
        """True if no pair differs by more than rounding changes the metric."""
        return self._differs_at_most(max(_EQUAL, self.comparison.rounding))

    def _differs_at_most(self, share: float) -> bool:
        known = [abs(median) for median in self.comparison.medians if np.isfinite(median)]
        return bool(np.abs(self.comparison.differences).max() <= max(ROUNDING, share * max(known, default=0.0)))

    @property
    def full_names(self) -> tuple[str, str]:
        """The names; numbers with their axis, such as "controller.period=0.01"."""
        axis = self.pairs.axis if self.pairs else ""
        first, second = (f"{axis}={name}" if axis else name for name in self.names)
        return first, second

    @property
    def names(self) -> tuple[str, str]:
        """Names of what is compared: levels of an axis, or sweeps."""
        return (self.pairs.first, self.pairs.second) if self.pairs else ("A", "B")


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer(Asked):
    """A comparison, judged with the others of its family.

    Attributes:
        p_value: Its p, corrected for the family; None with too few pairs for any p.
        level: The level at which it was decided.
        family: Number of comparisons in the family.
        rank: Place of the family: 0 for the primary metric, 1 for others of the first screen, 2 for all others.
    """

    p_value: float | None
    level: float
    family: int
    rank: int

    @property
    def interval(self) -> tuple[float, float] | None:
        """The interval of the difference; None with too few pairs for its level."""
        return self.comparison.interval(self.level)

    @property
    def least(self) -> float:
        """The difference from which on it is an answer, whatever the plant leaves, in the metric's unit."""
        known = [abs(median) for median in self.comparison.medians if np.isfinite(median)]
        share = SHARE if "fraction" in self.metric else SHARE * max(known, default=0.0)
        return max(share, ROUNDING)

    @property
    def equal(self) -> bool:
        """True if all pairs are equal up to rounding, and their signs show no difference if rounding is not small."""
        return self._differs_at_most(_EQUAL) or (self.within_rounding and not self.sign)

    @property
    def sign(self) -> int:
        """-1 where the second may be called smaller, 1 where larger, 0 where neither may be said."""
        error, size = self.comparison.error or 0.0, abs(self.comparison.difference)
        told = self.p_value is not None and self.p_value < ALPHA and size > max(self.least, error)
        return int(np.sign(self.comparison.difference)) if told else 0

    @property
    def word(self) -> str:
        """Relation of the second to the first, or the reason why none is shown."""
        found, size = self.comparison, abs(self.comparison.difference)
        if self.p_value is None:
            return f"too few pairs to say ({found.n} of {SMALLEST_SAMPLE})"
        if self.p_value >= ALPHA:
            few = f"too few pairs for {self.family} comparisons ({found.n} of {fewest_pairs(self.level)})"
            return "no difference shown" if self.interval else few
        if size <= ROUNDING:
            return "no more than rounding"
        if found.error is not None and size <= found.error:
            left = quantity(found.error, self.unit, 2) if np.isfinite(found.error) else "a run fails on a finer step"
            return f"below what the plant's step leaves ({left})"
        if size <= self.least:
            return f"less than {SHARE:g} apart" if "fraction" in self.metric else f"less than {100 * SHARE:g} % apart"
        return "smaller" if self.sign < 0 else "larger"

    @property
    def cells(self) -> list[str]:
        """The cells of a table: HEADER, then the word."""
        found = self.comparison
        low, high = self.interval or (None, None)
        text, ends, shown = with_ends(found.difference, low, high, self.unit)
        return [
            text if np.isfinite(found.difference) else "beyond every number",
            "–" if low is None else _with_unit(ends, shown),
            str(found.n),
            f"{found.effect:.2f}",
            "–" if self.p_value is None else _chance(self.p_value),
            self.word,
        ]

    @property
    def plain_cells(self) -> list[Cell]:
        """The cells of a table in SI units: HEADER, then the word."""
        found = self.comparison
        return [
            Number(found.difference),
            Number(None, *(self.interval or ())),
            str(found.n),
            f"{found.effect:.2f}",
            "-" if self.p_value is None else f"{self.p_value:.2g}",
            self.word,
        ]

    def sentence(self, turns: str = "") -> str:
        """Return in one sentence how the second compares with the first, and without an answer what pairs can show.

        Args:
            turns: A sentence to put between both, with a space before it.
        """
        sizes = [quantity(one, self.unit, 2) if np.isfinite(one) else "never" for one in self.comparison.medians]
        first, second = (f"{name} ({size})" for name, size in zip(self.full_names, sizes, strict=True))
        head = f"{capital(title(self.metric))}:"
        if self.equal:
            return (
                f"{head} {first} and {second} are equal up to rounding{self._rounding()} ({self.comparison.n} pairs)."
            )
        one, other = self.comparison.medians
        if self.sign > 0 and self.share and other >= _TIMES * one > 0.0:
            times = number(other / one, 2)
            return f"{head} {times} times as large with {second} as with {first}, {self._evidence()}.{turns}"
        if self.sign:
            share = f"{self.share} " if self.share else ""
            return f"{head} {share}{self.word} with {second} than with {first}, {self._evidence()}.{turns}"
        if self.word == "no difference shown":
            return f"{head} no difference between {first} and {second} is shown, {self._evidence()}.{turns}{self.power}"
        return f"{head} {first} and {second}, {self.word}.{turns}{self.power}"

    @property
    def amount(self) -> str:
        """The size of the difference with its unit."""
        return self._alike([abs(self.comparison.difference)])[0].replace("never", "more than any number")

    @property
    def share(self) -> str:
        """The size of the difference in per cent of the first's median; empty for fractions and without medians."""
        return self._per_cent(abs(self.comparison.difference), self.comparison.medians[0])

    @property
    def power(self) -> str:
        """The smallest difference that these pairs can show, and how many would show less; empty with an answer.

        It follows from the scatter of the pairs' differences, and so from the correlation within pairs.
        """
        found = self.comparison
        if self.sign or not self.p_value or self.p_value < ALPHA:
            return "" if self.p_value is not None else f" At least {fewest_pairs(self.level)} pairs are needed."
        if self.interval is None:
            return f" At least {fewest_pairs(self.level)} pairs are needed."
        best, larger = found.smallest_shown(self.level), max(map(abs, found.medians))
        if not best or not np.isfinite(larger):
            return ""
        text = f" {found.n} pairs can show {self._with_share(best, larger)} at best"
        least = max(self.least, found.error or 0.0)
        wanted = next((share * larger for share in _SHARES if least <= share * larger < best), least)
        count = found.pairs_needed(wanted, self.level) if wanted < best else None
        return f"{text}{f'; {number(float(count), 2)} would show {self._with_share(wanted, larger)}' if count else ''}."

    def _with_share(self, size: float, median: float) -> str:
        share = self._per_cent(size, median)
        return f"{share} ({quantity(size, self.unit, 2)})" if share else quantity(size, self.unit, 2)

    def _per_cent(self, size: float, median: float) -> str:
        known = np.isfinite(size) and np.isfinite(median) and abs(median) > ROUNDING and "fraction" not in self.metric
        return f"{number(100.0 * size / abs(median), 2)} %" if known else ""

    def _rounding(self) -> str:
        """Return by how much rounding changes the metric, to follow a phrase; empty if that is known to be small."""
        share = self.comparison.rounding
        return f", which changes it by {number(100.0 * share, 2)} %" if share > SENSITIVE else ""

    def _evidence(self) -> str:
        """Return the difference with its interval, p and number of pairs as a phrase."""
        found = self.comparison
        ends: tuple[float, ...] = self.interval or ()
        if self.sign < 0:
            ends = tuple(-end for end in reversed(ends))
        size, *shown = self._alike([abs(found.difference) if self.sign else found.difference, *ends])
        told = [" to ".join([shown[0].partition(" ")[0], shown[1]])] if shown else []
        if self.sign and self.p_value is not None:
            told.append(f"p = {_chance(self.p_value)}".replace("= <", "<"))
        told += [f"no value in {a} and {b} of {found.n} draws" for a, b in [found.lost] if a or b]
        told += ["plant's own error not known"] if self.sign and found.error is None else []
        return f"{'by' if self.sign else 'difference'} {size} ({', '.join([*told, f'{found.n} pairs'])})"

    @property
    def short_cells(self) -> list[str]:
        """The cells of a short table: both medians and the difference in one unit, and whether it is sure."""
        found = self.comparison
        first, second, difference = self._alike([*found.medians, found.difference])
        if self.equal:
            shown = "0" if self._differs_at_most(_EQUAL) else difference
            return [first, second, shown, f"equal up to rounding{self._rounding()}"]
        share = f" ({'-' if found.difference < 0 else '+'}{self.share})" if self.share and found.difference else ""
        return [first, second, f"{difference}{share}", "yes" if self.sign else self.word]

    def _alike(self, values: Sequence[float]) -> list[str]:
        """Return values with two digits in one unit, that of the largest; "never" beyond every number."""
        factor, unit = choose_unit(max((abs(one) for one in values if np.isfinite(one)), default=None), self.unit)
        texts = [number(factor * one, 2) if np.isfinite(one) else "never" for one in values]
        return [text if text == "never" else f"{text} {unit}".strip() for text in texts]


def turns(one: Answer, answers: Sequence[Answer]) -> str:
    """Return the levels of the other axes at which the answer differs from that over all; empty without one.

    Args:
        one: The answer over all levels.
        answers: All answers of the same question.
    """
    same = [each for each in answers if each.at and (each.metric, each.names) == (one.metric, one.names)]
    other = [each for each in same if each.sign not in (0, one.sign)]
    if not other:
        return ""
    shown = [each for each in same if each.sign][:_MOST_TURNS]
    told = ", ".join(f"{each.word} by {each.amount} at {label_text(each.at)}" for each in shown)
    rest = len(same) - len(shown)
    levels = "level" if rest == 1 else "levels"
    return f" {one.full_names[1]} is {told}{f'; {rest} other {levels} in the table' if rest else ''}."


def sentences(answers: Sequence[Answer]) -> list[str]:
    """Return the answers of the first screen over all levels, as sentences, with the levels at which one changes sign.

    Without answers over all levels those at each level are returned, the first metric's first.
    """
    first = sorted((one for one in answers if one.rank < 2), key=lambda one: one.rank)
    overall = [one for one in first if not one.at]
    few = [one for one in first if one.interval is None]
    if len(few) == len(first) > 2:
        n, family, needed = max((one.comparison.n, one.family, fewest_pairs(one.level)) for one in first)
        pairs = "1 pair is" if n == 1 else f"{n} pairs are"
        return [f"{pairs} too few for {family} comparisons: at least {needed} pairs are needed."]
    if overall:
        texts = [one.sentence(turns(one, answers)) for one in overall]
    else:
        texts = [f"At {label_text(one.at)}: {one.sentence()}" for one in first]
    left = len(texts) - _MOST_SENTENCES
    return texts[:_MOST_SENTENCES] + ([f"{left} more are in the tables."] if left > 0 else [])


def ask(pairs: Sequence[Pairs], metrics: Sequence[str]) -> list[Asked]:
    """Return the comparisons of some pairs of cells in some metrics, without those that have no value."""
    return [
        Asked(metric, some.a.units[metric], found, some)
        for metric in metrics
        for some in pairs
        if (found := compare(some, metric)) is not None
    ]


def judge(asked: Sequence[Asked], first: Sequence[str]) -> list[Answer]:
    """Return the answers to a question, in the order of its comparisons.

    Args:
        asked: All comparisons that the question makes.
        first: Metrics of the first screen: the task's primary one, then others.
    """
    answers: dict[int, Answer] = {}
    places: list[list[int]] = [[], [], []]
    for place, one in enumerate(asked):
        places[0 if one.metric in first[:1] else 1 if one.metric in first else 2].append(place)
    for rank, family in enumerate(places):
        tested = [place for place in family if asked[place].comparison.p_value is not None]
        p_values = [asked[place].comparison.p_value or 0.0 for place in tested]
        corrected = dict(zip(tested, holm(p_values).tolist(), strict=True))
        levels = dict(zip(tested, holm_levels(p_values, ALPHA).tolist(), strict=True))
        for place in family:
            one, level = asked[place], levels.get(place, ALPHA / max(len(family), 1))
            judged = {"p_value": corrected.get(place), "level": level, "family": len(family), "rank": rank}
            answers[place] = Answer(one.metric, one.unit, one.comparison, one.pairs, **judged)
    return [answers[place] for place in range(len(asked))]


def short_table(answers: Sequence[Answer]) -> tuple[list[str | Column], list[list[str]]]:
    """Return header and rows of a short table: every metric over all levels, and the first screen's at each level.

    With more than two values compared, rows at each level would make a long table; the full tables have them.
    """
    overall = [one for one in answers if not one.at]
    names = list(dict.fromkeys(one.names for one in answers))
    several = len(names) > 1
    answers = overall if overall and several else overall + [one for one in answers if one.at and one.rank < 2]
    at = any(one.at for one in answers)
    first, second = ("first", "second") if several else names[0]
    header = ["metric", *["at"] * at, *["compared"] * several, *numbers(first, second, "difference"), "sure?"]
    rows = [
        [
            title(one.metric),
            *[one.place] * at,
            *[", ".join(one.names)] * several,
            *one.short_cells,
        ]
        for one in answers
    ]
    return header, rows


def _chance(p_value: float) -> str:
    return f"{p_value:.2g}" if p_value >= _SMALLEST else f"< {_SMALLEST:g}"


def _with_unit(ends: str, unit: str) -> str:
    """Return a range with its unit behind the last number."""
    low, high = ends.split(" to ")
    if high != "never":
        return f"{ends} {unit}".strip()
    return ends if low == "never" else f"{low} {unit}".strip() + " to never"
