"""Two configs compared repetition by repetition: equal seeds give both the same noise."""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from runner.statistics.interval import SMALLEST_SAMPLE, FloatArray, Interval, median_interval


@dataclass(frozen=True)
class Comparison:
    """How b differs from a on the same seeds.

    Attributes:
        difference: Median of b - a over the pairs, with its 95 % interval.
        effect: Matched-pairs rank-biserial correlation, -1 (b smaller in every pair) to 1 (b larger in every pair).
        p_value: Of the Wilcoxon signed-rank test, two-sided; None where the pairs are too few.
    """

    difference: Interval
    effect: float
    p_value: float | None

    @property
    def verdict(self) -> str:
        """What can be said: "smaller", "larger", "no difference shown" or "too few pairs to say"."""
        low, high = self.difference.low, self.difference.high
        if low is None or high is None:
            return f"too few pairs to say ({self.difference.n} of {SMALLEST_SAMPLE})"
        if high < 0:
            return "smaller"
        return "larger" if low > 0 else "no difference shown"


def compare_paired(a: FloatArray, b: FloatArray, seed: int = 0) -> Comparison:
    """Compare two configs run on the same seeds.

    The effect size is (W+ - W-) / (W+ + W-), W the sums of ranks of the differences' sizes (Kerby, "The simple
    difference formula", Comprehensive Psychology 3, 2014).

    Args:
        a: Values of the first config, shape (n,), one for each repetition; infinity is beyond every number, and two
            of these are equal. It needs one pair at least.
        b: Values of the second, in the same order.
        seed: Seed of the resampling.

    Raises:
        ValueError: If the shapes differ or there is no pair.
    """
    if a.shape != b.shape or a.ndim != 1 or not a.size:
        raise ValueError(f"pairs need two samples of one length, at least 1; found shapes {a.shape} and {b.shape}")
    difference = np.zeros(len(a))
    unequal = a != b
    difference[unequal] = b[unequal] - a[unequal]
    moved = difference[unequal]
    effect, p_value = 0.0, None
    if moved.size:
        ranks = stats.rankdata(np.abs(moved))
        effect = float(np.sum(np.sign(moved) * ranks) / np.sum(ranks))
    if len(a) >= SMALLEST_SAMPLE:
        p_value = float(stats.wilcoxon(moved).pvalue) if moved.size else 1.0
    return Comparison(median_interval(difference, seed), effect, p_value)
