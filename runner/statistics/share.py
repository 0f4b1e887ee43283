"""Confidence interval of a share: how often something happens, from how often it did."""

from dataclasses import dataclass

from scipy import stats

from runner.statistics.interval import CONFIDENCE


@dataclass(frozen=True)
class Share:
    """How many of some independent repetitions something holds of.

    Attributes:
        kept: Their number.
        of: Number of repetitions, one or more.
        low: Lower end of the 95 % interval of the probability behind it.
        high: Upper end.
    """

    kept: int
    of: int
    low: float
    high: float


def count_share(kept: int, of: int) -> Share:
    """Return a share with the exact 95 % interval of the probability behind it.

    Clopper and Pearson, "The Use of Confidence or Fiducial Limits Illustrated in the Case of the Binomial",
    Biometrika 26, 1934: it covers the probability in 95 % of cases or more, however small that is.

    Args:
        kept: How many, 0 to `of`.
        of: Number of repetitions, one or more.
    """
    tail = (1.0 - CONFIDENCE) / 2.0
    low = 0.0 if kept == 0 else float(stats.beta.ppf(tail, kept, of - kept + 1))
    high = 1.0 if kept == of else float(stats.beta.ppf(1.0 - tail, kept + 1, of - kept))
    return Share(kept, of, low, high)
