"""Answers by condition: the better law in each cell of a sweep, and where one pooled number describes all cells."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runner.base.quantities import ROUNDING, number
from runner.reporting.answers import Answer
from runner.reporting.comparison.pairs import Label, label_text
from runner.reporting.limits import is_saturated

ALIKE = 3.0
"""Largest ratio of the medians of a law over all conditions up to which they are pooled."""


@dataclass(frozen=True, eq=False)
class ConditionAnswers:
    """All comparisons of a metric under one condition.

    Attributes:
        at: The condition, such as {"robot": "panda"}.
        answers: Its answers, one for each pair of values of the question.
    """

    at: Label
    answers: Sequence[Answer]

    @cached_property
    def best(self) -> list[str]:
        """The names that no other one is smaller than; one name for a winner."""
        beaten = {one.names[one.sign > 0] for one in self.answers if one.sign}
        return [name for name in self.names if name not in beaten]

    @property
    def names(self) -> list[str]:
        """All names that are compared."""
        return list(dict.fromkeys(name for one in self.answers for name in one.names))

    @property
    def winner(self) -> str:
        """The name of the smallest one; empty if none may be said."""
        return self.best[0] if len(self.best) == 1 else ""

    @property
    def share(self) -> str:
        """By how many per cent the winner is smaller than the next one; empty without a winner."""
        won = [one for one in self.answers if one.smaller and one.smaller == self.winner]
        return min(won, key=_relative).printed.share if won else ""

    @property
    def word(self) -> str:
        """The answer in a few words, such as "operational_space -31 %", "equal", "at a limit" or "not shown"."""
        if self.winner:
            exactly = " exact" if all(one.comparison.exact for one in self.answers) else ""
            return f"{self.winner} {f'-{self.share}' if self.share else 'smaller'}{exactly}"
        if all(one.limit for one in self.answers):
            return "at a limit"
        if all(one.is_lost for one in self.answers):
            return "no value"
        if all(one.equal for one in self.answers):
            return "equal"
        if len(self.best) < len(self.names):
            return " or ".join(self.best)
        words = {one.word.partition(" (")[0] for one in self.answers}
        if all(one.comparison.exact for one in self.answers):
            return f"{' or '.join(sorted(words))}, exact"
        few = all(word.startswith("too few") for word in words)
        if few:
            return f"too few pairs ({max(one.fewest for one in self.answers)} would do)"
        if len(words) == 1 and words != {"no difference shown"}:
            return min(words)
        counts = [one.pairs_that_tell for one in self.answers if not one.sign]
        known = [count for count in counts if count]
        return f"not shown ({number(float(max(known)), 2)} pairs would)" if known else "not shown"

    @property
    def is_saturated(self) -> bool:
        """True if a joint of a compared cell is at its torque limit more often than the caveat allows."""
        pairs = [one.pairs for one in self.answers if one.pairs]
        return any(is_saturated(some.sides) for some in pairs)

    @property
    def size(self) -> float:
        """The largest difference of a pair of values, relative to the larger median."""
        return max(_relative(one) for one in self.answers)


def conditions_of(answers: Sequence[Answer], metric: str) -> list[ConditionAnswers]:
    """Return the conditions under which a metric is compared, in the order of the answers."""
    found: dict[str, list[Answer]] = {}
    for one in answers:
        if one.metric == metric and one.at:
            found.setdefault(label_text(one.at), []).append(one)
    return [ConditionAnswers(some[0].at, some) for some in found.values()]


def keep_described(answers: Sequence[Answer], whole: bool = True) -> list[Answer]:
    """Return answers without the pooled ones that do not describe their conditions.

    A pooled answer stays if all its conditions have its sign or none, and the medians of either side differ by at
    most the factor ALIKE between conditions.

    Args:
        answers: Pooled answers, and those under each condition.
        whole: False to leave out the conditions that a pooled answer describes.
    """
    finest = max((len(one.at) for one in answers), default=0)
    cells: dict[tuple[str, tuple[str, str]], list[Answer]] = {}
    for one in answers:
        if len(one.at) == finest:
            cells.setdefault((one.metric, one.names), []).append(one)
    kept: list[Answer] = []
    described: set[int] = set()
    for one in answers:
        same = cells.get((one.metric, one.names), ()) if len(one.at) < finest else ()
        inside = [each for each in same if one.at.items() <= each.at.items()]
        if describes(one, inside):
            kept.append(one)
            described.update(map(id, inside))
    return kept if whole else [one for one in kept if id(one) not in described]


def describes(pooled: Answer, cells: Sequence[Answer]) -> bool:
    """Return True if a pooled answer describes the answers in its cells; see `keep_described`."""
    cells = [one for one in cells if not one.is_lost]
    if not cells:
        return True
    if pooled.limit or {one.sign for one in cells} - {0, pooled.sign}:
        return False
    return all(_are_alike([one.comparison.medians[side] for one in cells]) for side in (0, 1))


def _are_alike(medians: Sequence[float]) -> bool:
    sizes = np.abs(medians)
    return bool(np.isfinite(sizes).all() and sizes.max() <= max(ALIKE * sizes.min(), ROUNDING))


def _relative(one: Answer) -> float:
    found = one.comparison
    largest = max(map(abs, found.medians))
    if one.is_lost:
        return 0.0
    if not np.isfinite(largest):
        return np.inf if found.difference else 0.0
    return float(abs(found.difference) / largest) if largest > ROUNDING else 0.0
