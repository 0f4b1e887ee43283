"""Comparisons that a question asks for: a metric of pairs of cells, with what is compared and where."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.quantities import ROUNDING
from runner.reporting.comparison.pairs import Pairs, compare, label_text
from runner.reporting.limits import find_limit
from runner.statistics import PairedComparison
from runner.statistics.conclusion import larger_median

EQUAL = 1e-9
"""Largest difference of a pair, relative to the larger median, that is rounding."""


@dataclass(frozen=True, eq=False)
class AskedComparison:
    """A comparison in one metric.

    Attributes:
        metric: Name of the metric.
        unit: Its unit.
        comparison: The second against the first, draw by draw.
        pairs: The compared cells.
        limit: Joint at its torque limit that the metric shows instead of a law; empty for none.
    """

    metric: str
    unit: str
    comparison: PairedComparison
    pairs: Pairs | None = None
    limit: str = ""

    @property
    def is_lost(self) -> bool:
        """True if no draw has a value in either."""
        return not self.comparison.n

    @property
    def is_tested(self) -> bool:
        """True if the difference is tested: something is drawn, has a value and is at no limit."""
        return not (self.limit or self.comparison.exact or self.is_lost)

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
        return self.differs_at_most(max(EQUAL, self.comparison.rounding))

    def differs_at_most(self, share: float) -> bool:
        """Return True if no pair differs by more than a share of the larger median."""
        return bool(np.abs(self.comparison.differences).max(initial=0.0) <= max(ROUNDING, share * self.larger))

    @property
    def larger(self) -> float:
        """The larger median, of the pairs with numbers; see `larger_median`."""
        return larger_median(self.comparison)

    @property
    def full_names(self) -> tuple[str, str]:
        """The names; numbers with their axis, such as "controller.period=0.01"."""
        axis = self.pairs.axis if self.pairs else ""
        return (f"{axis}={self.names[0]}", f"{axis}={self.names[1]}") if axis else self.names

    @property
    def names(self) -> tuple[str, str]:
        """Names of what is compared: levels of an axis, or sweeps."""
        return (self.pairs.first, self.pairs.second) if self.pairs else ("A", "B")


def ask(pairs: Sequence[Pairs], metrics: Sequence[str]) -> list[AskedComparison]:
    """Return the comparisons of some pairs of cells in some metrics, without those that have no value."""
    return [
        AskedComparison(metric, some.a.units[metric], found, some, find_limit(some.sides, metric))
        for metric in metrics
        for some in pairs
        if (found := compare(some, metric)) is not None
    ]
