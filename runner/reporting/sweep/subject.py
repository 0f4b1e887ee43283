"""Subject of a sweep report: cells, compared metrics and their order."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.quantities import label_with_unit, quantity
from runner.reporting.charts import palette
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.metric_titles import COSTS, metric_label, title, whole_metrics
from runner.store.axes import Axis
from runner.store.sweep import Sweep
from runner.sweeps.measurements import Measurements
from runner.sweeps.question import find_question
from runner.sweeps.table import median_ends

if TYPE_CHECKING:
    from runner.reporting.answers import Answer
    from runner.statistics import EffectAnalysis
    from runner.sweeps.tuning.key import TunedKey

MOST_METRICS = 5
"""Metrics that a report compares if the user names none."""

MOST_LOOKS = len(palette.LIGHT)
"""Levels of an axis that a figure shows: each has its own colour, mark and dash."""

MOST_GROUPS = 64
"""An axis with more values is divided into this many groups of neighbours where effects are computed."""

QUANTILE_RULE = (
    "A quantile is the smallest value that so large a share of the repetitions does not exceed: the value of one of "
    "them, never one between two (NumPy's inverted_cdf)."
)
"""Definition of quantiles in reports."""

_DECADE = 10.0
_LONGEST = 60  # characters of a value in a table


@dataclass(frozen=True)
class Subject:
    """A sweep as its report looks at it; of every metric less is better.

    Attributes:
        measurements: Its cells.
        metrics: The metrics compared; the first one ranks the cells.
    """

    measurements: Measurements
    metrics: Sequence[str]

    @property
    def axes(self) -> Sequence[Axis]:
        """The swept axes."""
        return self.measurements.axes

    @cached_property
    def medians(self) -> dict[str, FloatArray]:
        """Median of every metric in each cell, shape (cells,): infinite where it is beyond every number."""
        return {name: self.measurements.medians(name) for name in self.measurements.values}

    @cached_property
    def effects(self) -> "dict[str, EffectAnalysis]":
        """Effects of the axes on each compared metric, over all repetitions of all cells."""
        return {metric: self._analyse(self.measurements.values[metric]) for metric in self.metrics}

    def ends(self, metric: str) -> tuple[FloatArray, FloatArray]:
        """Return the ends of the 95 % interval of each cell's median, shape (cells,); NaN where repetitions are few."""
        return median_ends(np.sort(self.measurements.values[metric], axis=1))  # NaN, a missing repetition, is last

    def _analyse(self, values: FloatArray) -> "EffectAnalysis":
        from runner.statistics import axis_effects  # SciPy, a second, which the end of a sweep does without

        present = ~np.isnan(values).ravel()
        levels = {axis.name: np.repeat(group_levels(axis), values.shape[1])[present] for axis in self.axes}
        return axis_effects(levels, values.ravel()[present], self.measurements.draws.ravel()[present])

    @cached_property
    def order(self) -> NDArray[np.intp]:
        """The cells by ascending median of the first metric, failed ones last."""
        failed = np.array([status != "ok" for status in self.measurements.statuses])
        if not self.metrics:
            return np.argsort(failed, kind="stable")
        return np.lexsort((self.medians[self.metrics[0]], failed))

    @property
    def ranked(self) -> list[int]:
        """The cells that did not fail and have a number for the first metric, by ascending median."""
        if not self.metrics:
            return []
        medians, statuses = self.medians[self.metrics[0]], self.measurements.statuses
        return [cell for cell in self.order.tolist() if np.isfinite(medians[cell]) and statuses[cell] == "ok"]

    def looks(self, axis: Axis) -> dict[int, int]:
        """Return the looks of an axis: the index of colour, mark and dash of each group of levels that figures show.

        The axis of the question has the first looks. Those of the other axes follow, while there are enough for all.
        """
        asked = find_question(self.axes, self.measurements.question)
        first = 0
        for other in sorted(self.axes, key=lambda each: each is not asked):
            shown = spaced_indices(int(group_levels(other).max(initial=0)) + 1, MOST_LOOKS)
            first = first if first + len(shown) <= MOST_LOOKS else 0
            if other is axis:
                break
            first += len(shown)
        return {group: first + place for place, group in enumerate(shown)}

    def label(self, metric: str) -> str:
        """Return the title of a metric with its unit, as on the axis of a figure."""
        return metric_label(metric, self.measurements.units[metric])

    def cell_name(self, cell: int, axes: Sequence[Axis] | None = None) -> str:
        """Return the values of a cell on some axes, or all, such as "noise.position=0.001, torque_limits.max=20"."""
        shown = self.axes if axes is None else axes
        return ", ".join(f"{axis.name}={axis.text(int(axis.level[cell]))}" for axis in shown)

    def hint(self, cell: int) -> str:
        """Return the hint of a cell, the text at the pointer."""
        units = self.measurements.units
        found = [f"{title(name)} {_text(self.medians[name][cell], units[name])}" for name in self.metrics]
        failure = [self.measurements.failures[cell]] if self.measurements.failures[cell] else []
        return "; ".join([self.cell_name(cell), *found, *failure])

    def hints(self, cells: Sequence[int]) -> list[str]:
        """Return the hints of some cells."""
        return [self.hint(cell) for cell in cells]

    def hashes(self, cells: Sequence[int]) -> list[str]:
        """Return the hashes of some cells' runs."""
        return [self.measurements.hashes[cell] for cell in cells]


@dataclass(frozen=True)
class SweepSubject(Subject):
    """A stored sweep as its report looks at it: the subject of the sections of the report.

    Attributes:
        sweep: The stored sweep.
        runs_address: Address of the folder of runs, seen from the report, ending in a slash.
    """

    sweep: Sweep
    runs_address: str = ""

    @cached_property
    def answers(self) -> "list[Answer]":
        """The answers to the question of the sweep."""
        from runner.reporting.sweep.question import find_answers  # which imports this module

        return find_answers(self)

    @cached_property
    def texts(self) -> list[str]:
        """The answers in sentences."""
        from runner.reporting.sentences import sentences

        return sentences(self.answers)

    @property
    def is_compared(self) -> bool:
        """True if the sweep has an axis and a metric to compare."""
        return bool(self.metrics and self.axes)


def group_levels(axis: Axis) -> NDArray[np.intp]:
    """Return the level of each cell on an axis, shape (cells,): neighbours together where there are very many."""
    count = len(axis.values)
    return axis.level * MOST_GROUPS // count if count > MOST_GROUPS else axis.level


def key_label(key: "Axis | TunedKey") -> str:
    """Return a swept or tuned key with its unit, as on the axis of a figure."""
    return label_with_unit(key.name, key.unit)


def shorten(text: str, longest: int = _LONGEST) -> str:
    """Return a value of a config, cut to the width of a table's column."""
    return text if len(text) <= longest else f"{text[: longest - 3]}..."


def choose(measurements: Measurements, wanted: Sequence[str] = ()) -> Subject:
    """Return the subject of a report: the wanted metrics, or those that differ between the cells.

    Raises:
        RunnerError: If a metric asked for is none of the sweep's.
    """
    return Subject(measurements, tuple(measurements.named(wanted) if wanted else main_metrics([measurements])))


def main_metrics(sides: Sequence[Measurements], known: Collection[str] = ()) -> list[str]:
    """Return some errors and a cost: metrics of all sweeps that differ between their cells.

    Args:
        sides: The sweeps.
        known: Metrics that they are chosen from; empty for all.
    """
    whole = whole_metrics([name for name in known or sides[0].values if all(name in side.values for side in sides)])
    varying = [name for name in whole if _varies(np.concatenate([side.medians(name) for side in sides]))]
    chosen = (varying or whole)[:MOST_METRICS]
    cost = next((name for name in COSTS if name in varying), None)
    if cost is not None and cost not in chosen:
        chosen[-1] = cost  # what the others are traded off against
    return chosen


def spans_decades(values: FloatArray) -> bool:
    """Return True if values need a logarithmic scale: all positive, over a decade or more."""
    finite = values[np.isfinite(values)]
    return bool(finite.size and finite.min() > 0 and finite.max() >= _DECADE * finite.min())


def _varies(medians: FloatArray) -> bool:
    finite = medians[np.isfinite(medians)]
    return bool(finite.size and np.any(finite != finite[0]))


def _text(median: float, unit: str) -> str:
    if np.isnan(median):
        return "–"
    return quantity(float(median), unit) if np.isfinite(median) else "never"
