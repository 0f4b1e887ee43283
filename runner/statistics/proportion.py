"""Exact confidence interval of a proportion (Clopper and Pearson)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import betaincinv

from runner.base.arrays import FloatArray
from runner.statistics.interval import CONFIDENCE

IntArray = NDArray[np.integer]

_TAIL = (1.0 - CONFIDENCE) / 2.0  # of either side
_MOST = 10**15  # repetitions; more are not plausible


@dataclass(frozen=True)
class Share:
    """Number of independent repetitions for which a statement holds.

    Attributes:
        kept: Their number.
        of: Number of repetitions, one or more.
        low: Lower end of the 95 % interval of the probability.
        high: Upper end.
    """

    kept: int
    of: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """The proportion of these repetitions."""
        return self.kept / self.of

    @property
    def rest(self) -> "Share":
        """The number of the other repetitions."""
        return count_share(self.of - self.kept, self.of, self.exact)

    @property
    def exact(self) -> bool:
        """True if nothing is drawn: the interval is the proportion itself."""
        return self.low == self.high


def count_share(kept: int, of: int, exact: bool = False) -> Share:
    """Return a share with the exact 95 % interval of the probability.

    Clopper and Pearson, "The Use of Confidence or Fiducial Limits Illustrated in the Case of the Binomial",
    Biometrika 26, 1934: the lower end is the probability with which this many or more happen in 2.5 % of all cases, the
    upper end that with which this many or fewer do. Both are quantiles of beta distributions. The interval covers the
    probability in 95 % of cases or more, whatever that is; in more, as a count is a whole number.

    Args:
        kept: How many, 0 to `of`.
        of: Number of repetitions, one or more.
        exact: True if nothing is drawn, so that further repetitions would be the same.
    """
    low, high = share_ends(np.array([kept]), np.array([of]), exact)
    return Share(kept, of, float(low[0]), float(high[0]))


def share_ends(kept: IntArray, of: IntArray, exact: NDArray[np.bool_] | bool = False) -> tuple[FloatArray, FloatArray]:
    """Return the ends of the intervals of several shares, as `count_share` has them.

    Args:
        kept: How many, shape (n,).
        of: Number of repetitions of each, one or more, shape (n,).
        exact: True where nothing is drawn, shape (n,), or for all.
    """
    none, every = kept == 0, kept == of
    low = np.where(none, 0.0, betaincinv(np.where(none, 1, kept), of - kept + 1, _TAIL))
    high = np.where(every, 1.0, betaincinv(kept + 1, np.where(every, 1, of - kept), 1.0 - _TAIL))
    return np.where(exact, kept / of, low), np.where(exact, kept / of, high)


def needed_repetitions(seen: Share, probability: float) -> int | None:
    """Return the total number of repetitions that distinguishes a constant proportion from a probability.

    None where no number does: the share is the probability itself. Of a share of 0 it is ln(0.025) / ln(1 - p).

    Args:
        seen: The share so far.
        probability: The probability, above 0 and below 1.
    """
    if seen.kept == 0:
        return math.ceil(math.log(_TAIL) / math.log1p(-probability))
    few, many = seen.of, seen.of
    while not _tells(seen, probability, many):
        few, many = many, 2 * many
        if many > _MOST:
            return None
    while many - few > max(1, few // 1000):
        middle = (few + many) // 2
        few, many = (few, middle) if _tells(seen, probability, middle) else (middle, many)
    return many


def _tells(seen: Share, probability: float, of: int) -> bool:
    found = count_share(round(seen.kept / seen.of * of), of)
    return found.high < probability or found.low > probability
