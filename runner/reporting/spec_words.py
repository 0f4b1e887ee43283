"""Text of a spec: bounds, pass rates and failure probabilities."""

from collections.abc import Collection
from typing import TYPE_CHECKING

from runner.base.errors import nearest
from runner.base.quantities import format_range, number, quantity
from runner.config.spec import Bound
from runner.plugins.metric_units import unit_of
from runner.reporting.metric_titles import title
from runner.statistics.spec.history import History, ends_of, set_after

if TYPE_CHECKING:
    from runner.statistics.proportion import Share
    from runner.statistics.spec import Spec

HEADER = ("bound", "kept", "probability of failing", "95 % interval")
_ALL = "all of them"
_DIGITS = 6  # of a bound, which is given, not measured


def spec_rows(spec: "Spec") -> list[tuple[str, str, str, str]]:
    """Return a row of HEADER for each bound, and one for all where there are several."""
    rows = [
        (bound_text(one.metric, one.bound) + late_text(one.metric, one.bound, one.history), *share_texts(one.share))
        for one in spec.bounds
    ]
    if len(rows) > 1:
        rows.append((_ALL, "–", "–", "–") if spec.whole is None else (_ALL, *share_texts(spec.whole)))
    return rows


def bound_text(metric: str, bound: Bound) -> str:
    """Return what a bound demands, such as "settling time at most 1.6 s"."""
    return f"{title(metric)} {_ends_text(metric, bound.min, bound.max)}"


def late_text(metric: str, bound: Bound, history: History) -> str:
    """Return, to be appended, that a bound was set after the result was known, and what stood before; else nothing."""
    date, before = set_after(history, ends_of(bound))
    told = ", then ".join(_ends_text(metric, *ends) for ends in before)
    return f", set after the result was known ({date}; before: {told})" if date else ""


def _ends_text(metric: str, low: float | None, high: float | None) -> str:
    unit = unit_of(metric) or "1"
    if low is None:
        return "none" if high is None else f"at most {quantity(high, unit, _DIGITS)}"
    return f"at least {quantity(low, unit, _DIGITS)}" if high is None else format_range(low, high, unit)


def share_texts(share: "Share | None") -> tuple[str, str, str]:
    """Return how often a bound is kept, the share of failing repetitions, and the interval of its probability."""
    if share is None:
        return "no such metric", "–", "–"
    failing = share.rest
    return f"{share.kept} of {share.of}", probability(failing.share), interval_text(failing)


def interval_text(share: "Share") -> str:
    """Return the ends of the interval of a probability."""
    return f"{probability(share.low)} to {probability(share.high)}"


def probability(value: float) -> str:
    """Return a probability with three digits, below a thousandth with a power of ten."""
    return str(number(value, plain=1e-3))


def lacking_text(spec: "Spec", known: Collection[str]) -> str:
    """Return which metrics of its spec a run lacks, with the nearest that it has; empty where it has all."""
    if not spec.lacking:
        return ""
    named = ", ".join(f"{metric}{nearest(metric, known)}" for metric in spec.lacking)
    return f"spec: the run has no {named}, so it cannot be judged by that; it has: {', '.join(known)}"
