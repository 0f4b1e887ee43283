"""Paired comparison of cells on common seeds, and of the levels of one sweep axis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.errors import RunnerError, nearest
from runner.reporting.answers import Asked
from runner.statistics import Comparison, subtract
from runner.sweeps.measurements import Axis, Measurements, check_metrics

SEED = "seed"
"""The axis whose levels are draws of one thing, as repetitions are."""
MOST_PAIRS = 1_000
"""Of more draws so many are taken at random: a million means of two are sorted in a tenth of a second."""
Cells = NDArray[np.intp]


@dataclass(frozen=True)
class CellPairs:
    """Cells that are compared pair by pair: the same place in both arrays.

    Attributes:
        a: Numbers of the first cells, shape (n,).
        b: Numbers of the second ones, likewise; of the same sweep or of another one.
    """

    a: Cells
    b: Cells


def share_seeds(a: Measurements, b: Measurements, pairs: CellPairs) -> NDArray[np.bool_]:
    """Return for each pair whether both cells have the same random draws in each repetition, shape (n,)."""
    if a is b and not len(a.seeds):
        return np.ones(len(pairs.a), dtype=bool)
    same: NDArray[np.bool_] = np.asarray(a.seeds)[pairs.a] == np.asarray(b.seeds)[pairs.b]
    return same


def compare(a: Measurements, b: Measurements, metric: str, pairs: CellPairs) -> Comparison | None:
    """Return how the second cells differ from the first in a metric; None where no repetition is in both.

    Each draw, that is a repetition of a seed, counts once, with the mean over the pairs of cells: cells of one seed
    share its draws, so that they are no further evidence. Where repetitions are copies of each other, as nothing is
    drawn, the first one counts alone. Of more than MOST_PAIRS draws so many are taken, always the same.

    Args:
        a: The first sweep.
        b: The second sweep, or the same again.
        metric: Name of a metric of both.
        pairs: The cells.
    """
    copies = bool(a.copies[pairs.a].all() and b.copies[pairs.b].all())
    first, second, draws = _entries(a, b, a.values, b.values, metric, pairs, 1 if copies else None)
    both = ~np.isnan(first) & ~np.isnan(second)
    if not both.any():
        return None
    kept, draw = np.unique(draws[both], return_inverse=True)
    differences = subtract(second[both], first[both])
    if len(kept) > MOST_PAIRS:
        chosen = np.sort(np.random.default_rng(0).choice(len(kept), MOST_PAIRS, replace=False))
    else:
        chosen = np.arange(len(kept))
    one, other, by_draw = (_mean_by(draw, values)[chosen] for values in (first[both], second[both], differences))
    found = Comparison(one, other, by_draw)
    return replace(found, error=_error(a, b, metric, pairs)) if metric in a.finer and metric in b.finer else found


def _error(a: Measurements, b: Measurements, metric: str, pairs: CellPairs) -> float | None:
    """Return by how much a finer step of the plant changes a difference in the median draw; None if not known."""
    width = min(a.finer[metric].shape[1], b.finer[metric].shape[1])
    first, second, draws = _entries(a, b, a.values, b.values, metric, pairs, width)
    finer_first, finer_second, _ = _entries(a, b, a.finer, b.finer, metric, pairs, width)
    here = ~np.isnan(first) & ~np.isnan(second)
    known = ~np.isnan(finer_first) & ~np.isnan(finer_second)
    whole = here & ~np.isin(draws, draws[here & ~known])  # draws of which every pair is known
    if not whole.any():
        return None
    draw = np.unique(draws[whole], return_inverse=True)[1]
    own = _mean_by(draw, subtract(second[whole], first[whole]))
    finer = _mean_by(draw, subtract(finer_second[whole], finer_first[whole]))
    return float(np.median(np.abs(subtract(own, finer))))


def _entries(
    a: Measurements,
    b: Measurements,
    of_a: Mapping[str, FloatArray],
    of_b: Mapping[str, FloatArray],
    metric: str,
    pairs: CellPairs,
    most: int | None,
) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Return a metric in the first and the second cell of each pair, and the draw behind both, by repetition."""
    width = min(of_a[metric].shape[1], of_b[metric].shape[1])
    shown = slice(width if most is None else min(width, most))
    first, second = of_a[metric][pairs.a, shown], of_b[metric][pairs.b, shown]
    return first.ravel(), second.ravel(), a.draws[pairs.a, shown].ravel()


def _mean_by(group: NDArray[np.intp], values: FloatArray) -> FloatArray:
    """Return the mean of the values of each group; infinite where more of them are so on one side than on the other."""
    finite = np.isfinite(values)
    beyond = np.bincount(group, np.where(finite, 0.0, np.sign(values)))
    sums = np.bincount(group, np.where(finite, values, 0.0))
    counts = np.maximum(np.bincount(group, finite), 1.0)
    means: FloatArray = np.where(beyond == 0.0, sums / counts, np.copysign(np.inf, beyond))
    return means


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


@dataclass(frozen=True, eq=False)
class LevelComparison(Asked):
    """How one level of an axis differs from another one in one metric.

    Attributes:
        axis: Name of the axis.
        pair: The two levels, what they are compared within, and their cells.
    """

    axis: str
    pair: LevelPair


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
        found += [LevelComparison(name, unit, result, axis, pair) for pair, result in compared if result is not None]
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
