"""Paired comparison of matching cells on common random seeds."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.statistics import Comparison, subtract
from runner.sweeps.measurements import Measurements

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
