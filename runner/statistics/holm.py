"""Holm correction for multiple tests."""

from collections.abc import Sequence

import numpy as np

from runner.base.arrays import FloatArray


def holm(p_values: Sequence[float]) -> FloatArray:
    """Return p-values of a family of tests, corrected so that one or more false rejections have the stated probability.

    The k-th smallest of m, k from 1, is multiplied by m + 1 - k, and is no smaller than those before it, no larger than
    1 (Holm, "A simple sequentially rejective multiple test procedure", Scandinavian J. Statistics 6, 1979). It
    demands nothing of how the tests depend on each other.

    Args:
        p_values: Those of the tests, shape (m,).

    Returns:
        The corrected ones, shape (m,), in the same order.
    """
    given = np.asarray(p_values, dtype=float)
    order = np.argsort(given, kind="stable")
    corrected = np.empty(len(given))
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(given[order] * np.arange(len(given), 0, -1)))
    return corrected


def holm_levels(p_values: Sequence[float], alpha: float) -> FloatArray:
    """Return the level at which Holm's procedure decides each test of a family: it rejects what is below its level.

    The k-th smallest p-value of m is compared with alpha / (m + 1 - k); after the first that is not below, all that
    follow are decided at that same level.

    Args:
        p_values: Those of the tests, shape (m,).
        alpha: Probability of one or more false rejections.
    """
    given = np.asarray(p_values, dtype=float)
    order = np.argsort(given, kind="stable")
    steps = alpha / np.arange(len(given), 0, -1)
    kept = np.flatnonzero(given[order] >= steps)
    levels = np.empty(len(given))
    levels[order] = np.minimum(steps, steps[kept[0]]) if kept.size else steps
    return levels
