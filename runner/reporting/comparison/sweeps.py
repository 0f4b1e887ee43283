"""Comparison of two sweeps by cell and repetition."""

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError
from runner.base.quantities import ROUNDING
from runner.reporting.answers import Asked
from runner.reporting.comparison.cells import Matched, match
from runner.reporting.comparison.differences import Beyond, find_differences
from runner.reporting.comparison.operand import Side
from runner.reporting.comparison.pairs import CellPairs, compare
from runner.sweeps.measurements import check_metrics, is_part

MOST_MOVEMENTS = 12
"""Cells with the largest differences that are named."""

_MOST_OF_ONE = 3  # of them in one metric


@dataclass(frozen=True, eq=False)
class MetricComparison(Asked):
    """How the second sweep differs from the first in one metric.

    Attributes:
        below: Number of cells in which the median of the differences is below zero.
        above: Number of cells in which it is above zero.
        cell: Label of the cell, where it is of one; empty over all cells.
    """

    below: int
    above: int
    cell: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class SweepComparison:
    """How the second of two sweeps differs from the first.

    Attributes:
        a: The first.
        b: The second.
        matched: Which cells belong together.
        beyond: What differs between these.
        pooled: Each metric over all cells.
        cells: The cells with the largest differences in a metric, in relation to its size; the largest first.
        candidates: How many cells and metrics these were chosen from.
        noise_alone: Whether repetitions differ in their noise alone, as mismatch.spread is 0 in both.
    """

    a: Side
    b: Side
    matched: Matched
    beyond: Beyond
    pooled: Sequence[MetricComparison]
    cells: Sequence[MetricComparison]
    candidates: int
    noise_alone: bool


def compare_sweeps(a: Side, b: Side, metrics: Sequence[str] = ()) -> SweepComparison:
    """Compare two sweeps in the cells and repetitions that both have.

    Args:
        a: The first, which the second is compared with.
        b: The second.
        metrics: Names of metrics; empty for all that both have.

    Raises:
        RunnerError: If they share no cell, no seed or no metric, or have no such metric.
    """
    matched = match(a, b)
    both = [name for name in a.measurements.values if name in b.measurements.values]
    if not both:
        raise RunnerError(f"{a.name} and {b.name} have no metric in common: all runs of one of them failed")
    check_metrics(metrics, both)
    names = list(dict.fromkeys(metrics)) or both
    pooled = [found for name in names if (found := _compared(a, b, name, matched.pairs, {})) is not None]
    whole = list(metrics) or [name for name in names if not is_part(name)]
    cells, candidates = _movements(a, b, whole, matched)
    configs = [config for side in (a, b) for config, _ in side.measurements.configs]
    repeated = min(a.measurements.repetitions, b.measurements.repetitions) > 1
    alone = repeated and noise_alone(configs)
    return SweepComparison(a, b, matched, find_differences(a, b, matched), pooled, cells, candidates, alone)


def by_cell(found: SweepComparison, metric: str) -> list[MetricComparison]:
    """Return a metric cell by cell, of those cells that have it."""
    matched = found.matched
    compared = (
        _compared(found.a, found.b, metric, CellPairs(a[None], b[None]), label)
        for a, b, label in zip(matched.pairs.a, matched.pairs.b, matched.labels, strict=True)
    )
    return [one for one in compared if one is not None]


def _compared(a: Side, b: Side, name: str, pairs: CellPairs, cell: Mapping[str, str]) -> MetricComparison | None:
    comparison = compare(a.measurements, b.measurements, name, pairs)
    if comparison is None:
        return None
    moved = _median_differences(a.measurements.values[name], b.measurements.values[name], pairs)
    below, above = int(np.sum(moved < -ROUNDING)), int(np.sum(moved > ROUNDING))
    return MetricComparison(name, a.measurements.units[name], comparison, below, above, cell)


def _movements(a: Side, b: Side, names: Sequence[str], matched: Matched) -> tuple[list[MetricComparison], int]:
    """Return the cells with the largest differences, and of how many in all metrics; none where only one cell is."""
    count = len(matched.labels)
    if count < 2:
        return [], 0
    sizes = [_relative(a.measurements.values[name], b.measurements.values[name], matched.pairs) for name in names]
    moved = np.nan_to_num(np.array(sizes), nan=0.0, posinf=np.inf)
    found: list[MetricComparison] = []
    for place in np.argsort(-moved, axis=None, kind="stable").tolist():
        metric, pair = divmod(place, count)
        if len(found) == MOST_MOVEMENTS or not moved[metric, pair]:
            break
        if sum(one.metric == names[metric] for one in found) == _MOST_OF_ONE:
            continue
        pairs = CellPairs(matched.pairs.a[pair : pair + 1], matched.pairs.b[pair : pair + 1])
        one = _compared(a, b, names[metric], pairs, matched.labels[pair])
        found += [] if one is None else [one]
    return found, int(np.sum(~np.isnan(sizes)))


def _relative(a: FloatArray, b: FloatArray, pairs: CellPairs) -> FloatArray:
    """Return how far the median of each pair's differences is from zero, over the larger median; NaN without values."""
    moved = np.abs(_median_differences(a, b, pairs))
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of cells without values
        largest = np.fmax(*(np.abs(np.nanmedian(some, axis=1)) for some in (a[pairs.a], b[pairs.b])))
    known = np.isfinite(largest) & (largest > ROUNDING)
    sizes = np.where(moved > ROUNDING, np.where(known, moved / np.where(known, largest, 1.0), np.inf), 0.0)
    return np.where(np.isnan(moved), np.nan, sizes)


def _median_differences(a: FloatArray, b: FloatArray, pairs: CellPairs) -> FloatArray:
    """Return the median of the differences of each pair of cells, shape (n,); NaN where no repetition is in both."""
    width = min(a.shape[1], b.shape[1])
    first, second = a[pairs.a, :width], b[pairs.b, :width]
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        found: FloatArray = np.nanmedian(np.where(first == second, 0.0, second - first), axis=1)
    return found


def noise_alone(configs: Iterable[Mapping[str, Any]]) -> bool:
    """Tell whether the repetitions of runs draw nothing but noise: nothing of the arm is drawn from the seed."""
    mismatches = [config.get("mismatch", {}) for config in configs]
    return all(not mismatch.get("spread") and "kind" not in mismatch for mismatch in mismatches)
