"""Two configs compared repetition by repetition: equal seeds give both the same noise."""

from dataclasses import dataclass

import numpy as np

from runner.statistics.interval import SMALLEST_SAMPLE, FloatArray, Interval, median_interval
from runner.statistics.signed_rank import signed_rank


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

    Effect size and p-value are those of `signed_rank`.

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
    effect, p_value = signed_rank(difference)
    return Comparison(median_interval(difference, seed), effect, p_value if len(a) >= SMALLEST_SAMPLE else None)
