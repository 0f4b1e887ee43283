"""How often the interval of a share holds the truth, worked out exactly."""

import numpy as np
from scipy.stats import binom

from runner.statistics.share import share_ends


def coverage(n: int, p: float) -> float:
    """Return with which probability the interval of n repetitions holds p: a sum over all counts, no simulation."""
    counts = np.arange(n + 1)
    low, high = share_ends(counts, np.full(n + 1, n))
    return float(binom.pmf(counts, n, p)[(low <= p) & (p <= high)].sum())
