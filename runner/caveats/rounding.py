"""Caveat on the growth of rounding errors."""

from runner.caveats.rounding_growth import RoundingGrowth
from runner.caveats.rule import Caveat, percent
from runner.schema.bound import Range

NAME = "rounding_grows"


def caveat_of(growth: RoundingGrowth, threshold: float) -> Caveat | None:
    """Return the caveat on a run whose metrics, or whose failure, depend on rounding; None if they do not.

    Args:
        growth: Changes of the run through a moved start.
        threshold: Allowed relative change.
    """
    allowed = Range(high=threshold)
    if not allowed.exceeded(growth.largest):
        return None
    head = f"rounding errors grow by a factor of {growth.factor:.2g} until t = {growth.at:.4g} s"
    text = f"{head}: another processor gives {_told(growth, allowed)}; judge it by repetitions with noise"
    return Caveat(NAME, text, growth.largest)


def _told(growth: RoundingGrowth, allowed: Range) -> str:
    own, moved = growth.failures
    if own != moved:
        return f"{_failing(moved)} instead of {_failing(own)}"
    sensitive = [name for name, change in growth.metrics.items() if allowed.exceeded(change)]
    worst = max(sensitive, key=growth.metrics.__getitem__)
    count = f"{len(sensitive)} of {len(growth.metrics)} metrics"
    return f"other values of {count}, of {worst} by {percent(growth.metrics[worst])}"


def _failing(time: float | None) -> str:
    return "no failure" if time is None else f"a failure at {time:.6g} s"
