"""Coverage of the interval of a share, computed exactly."""

from functools import cache

import numpy as np
from scipy.stats import binom

from runner.statistics.proportion import share_ends


def coverage(n: int, p: float) -> float:
    """Return with which probability the interval of n repetitions holds p: a sum over all counts, no simulation."""
    counts = np.arange(n + 1)
    low, high = _ends(n)
    return float(binom.pmf(counts, n, p)[(low <= p) & (p <= high)].sum())


@cache
def _ends(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of the intervals of all counts of n repetitions."""
    return share_ends(np.arange(n + 1), np.full(n + 1, n))
