"""Comparison of the levels of one sweep axis, within each combination of the other axes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.errors import RunnerError, nearest
from runner.reporting.comparison.pairs import CellPairs, Cells, compare
from runner.statistics import Comparison
from runner.sweeps.measurements import Axis, Measurements, check_metrics

SEED = "seed"
"""The axis whose levels are draws of one thing, as repetitions are."""


@dataclass(frozen=True)
class LevelPair:
    """Two levels of an axis where all else that was swept is the same.

    Attributes:
        at: Level of each axis that the two are compared within, as text.
        first: The first level, as text.
        second: The second one.
        cells: The cells of both, pair by pair.
    """

    at: Mapping[str, str]
    first: str
    second: str
    cells: CellPairs


@dataclass(frozen=True)
class LevelComparison:
    """How one level of an axis differs from another one in one metric.

    Attributes:
        axis: Name of the axis.
        pair: The two levels, what they are compared within, and their cells.
        metric: Name of the metric.
        unit: Its unit.
        comparison: The second level against the first.
    """

    axis: str
    pair: LevelPair
    metric: str
    unit: str
    comparison: Comparison


def levels(
    measurements: Measurements, axis: str, within: Sequence[str] | None = None, metrics: Sequence[str] = ()
) -> list[LevelComparison]:
    """Compare the levels of one axis of a sweep: each with the first one, in every metric.

    The first level is the smallest number, or the text that the sweep names first.

    Args:
        measurements: The sweep.
        axis: The axis, such as "controller".
        within: Axes within each combination of whose levels the comparison is made; None for over all others, and then
            within all of them but the seed. Cells of the remaining axes are pooled: the two cells of a pair have the
            same levels of all other axes and the same seed, and the pairs of one draw count once.
        metrics: Names of metrics; empty for all.

    Raises:
        RunnerError: If the sweep has no such axis or metric, or no two cells share their seeds.
    """
    check_metrics(metrics, measurements.values)
    pairs = level_pairs(measurements, axis, within)
    if within is None and any(pair.at for pair in pairs):
        pairs = [*level_pairs(measurements, axis, ()), *pairs]
    if not pairs:
        raise RunnerError(
            f"{axis}: no two cells differ in it alone and share their seed, so none are compared in pairs; sweep it "
            "with one seed, or over the same seeds for each value"
        )
    found = []
    for name in dict.fromkeys(metrics or measurements.values):
        compared = [(pair, compare(measurements, measurements, name, pair.cells)) for pair in pairs]
        unit = measurements.units[name]
        found += [LevelComparison(axis, pair, name, unit, result) for pair, result in compared if result is not None]
    return found


def level_pairs(measurements: Measurements, axis: str, within: Sequence[str] | None = None) -> list[LevelPair]:
    """Return pairs of levels of an axis without comparing them; none where no two share seeds.

    Args:
        measurements: The sweep.
        axis: The axis.
        within: Axes within each combination of whose levels they stand; None for all others but the seed.

    Raises:
        RunnerError: If the sweep has no such axis.
    """
    chosen = _named(measurements, axis)
    others = [other for other in measurements.axes if other is not chosen]
    inner = [other.name for other in others if other.name != SEED] if within is None else within
    shown = [_named(measurements, name) for name in inner]
    if chosen in shown:
        raise RunnerError(f"{axis}: is compared, so it cannot be compared within, too")
    groups: dict[tuple[int, ...], list[int]] = {}
    for cell, at in enumerate(_levels_of(shown, np.arange(len(measurements.hashes)))):
        groups.setdefault(at, []).append(cell)
    pooled = [other for other in others if other not in shown]
    seeds = np.asarray(measurements.seeds).tolist()
    texts = [chosen.text(level) for level in range(len(chosen.values))]
    found = []
    for at, cells in sorted(groups.items()):
        names = {other.name: other.text(level) for other, level in zip(shown, at, strict=True)}
        for first, second, pairs in _against_first(chosen, pooled, np.array(cells)):
            kept = [pair for pair in pairs if not seeds or seeds[pair[0]] == seeds[pair[1]]]
            if kept:
                a, b = np.array(kept).T
                found.append(LevelPair(names, texts[first], texts[second], CellPairs(a, b)))
    return found


def _against_first(axis: Axis, pooled: Sequence[Axis], cells: Cells) -> list[tuple[int, int, list[tuple[int, int]]]]:
    """Return the levels of an axis among some cells, each with the first, and their cells that have equal others."""
    at_level: dict[int, dict[tuple[int, ...], int]] = {}
    for cell, level, place in zip(cells.tolist(), axis.level[cells].tolist(), _levels_of(pooled, cells), strict=True):
        at_level.setdefault(level, {})[place] = cell
    first, *rest = sorted(at_level)
    of_first = at_level[first]
    found = []
    for level in rest:
        pairs = [(of_first[place], cell) for place, cell in at_level[level].items() if place in of_first]
        found.append((first, level, pairs))
    return found


def _levels_of(axes: Sequence[Axis], cells: Cells) -> list[tuple[int, ...]]:
    """Return the levels of some cells on some axes, a tuple for each cell."""
    return list(zip(*(axis.level[cells].tolist() for axis in axes), strict=True)) if axes else [()] * len(cells)


def _named(measurements: Measurements, name: str) -> Axis:
    names = [axis.name for axis in measurements.axes]
    if name not in names:
        known = ", ".join(names) or "nothing"
        raise RunnerError(f"the sweep has no axis '{name}'{nearest(name, names)}; it was swept over: {known}")
    return measurements.axes[names.index(name)]
