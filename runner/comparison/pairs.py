"""Values that belong together pair by pair, and how the second of each pair differs from the first."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.statistics import Comparison, compare_paired
from runner.sweeps.measurements import FloatArray, Measurements

MOST_PAIRS = 5_000
"""Of more pairs so many are drawn at random, as the bootstrap would take minutes."""

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


def paired_values(a: FloatArray, b: FloatArray, pairs: CellPairs) -> tuple[FloatArray, FloatArray]:
    """Return the values that both cells of a pair have, repetition by repetition, each of shape (n,).

    Args:
        a: A metric in the cells of the first sweep, shape (cells, repetitions), NaN where there is none.
        b: The same metric in the second.
        pairs: The cells.
    """
    width = min(a.shape[1], b.shape[1])
    first, second = a[pairs.a, :width].ravel(), b[pairs.b, :width].ravel()
    both = ~np.isnan(first) & ~np.isnan(second)
    return first[both], second[both]


def compare(a: FloatArray, b: FloatArray, pairs: CellPairs) -> Comparison | None:
    """Return how the second cells differ from the first; None where no repetition is in both.

    Of more than MOST_PAIRS pairs of values so many are drawn, always the same.

    Args:
        a: A metric in the cells of the first sweep, shape (cells, repetitions).
        b: The same metric in the second.
        pairs: The cells.
    """
    first, second = paired_values(a, b, pairs)
    if len(first) > MOST_PAIRS:
        drawn = np.sort(np.random.default_rng(0).choice(len(first), MOST_PAIRS, replace=False))
        first, second = first[drawn], second[drawn]
    return compare_paired(first, second) if len(first) else None
