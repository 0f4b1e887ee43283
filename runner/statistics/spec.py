"""Number of a run's repetitions within each bound of a spec, verdicts, and the history of bounds."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.schema.bound import Bound

if TYPE_CHECKING:
    from runner.statistics.proportion import Share

History = Sequence[Sequence[Any]]
"""Dates on which bounds or claims were first set, each with its value; the first stood when the result was made."""
Histories = Mapping[str, History]


def ends_of(bound: Bound | None) -> list[float | None]:
    """Return the ends of a bound as a history has them; None is not a bound."""
    return [None, None] if bound is None else [bound.min, bound.max]


def settings(bounds: Mapping[str, Bound | None], date: str) -> Histories:
    """Return histories that begin with some bounds."""
    return {metric: [[date, ends_of(bound)]] for metric, bound in bounds.items()}


def merge_histories(*histories: Histories) -> dict[str, list[Sequence[Any]]]:
    """Return histories one after the other, each value with the date on which it was first set."""
    found: dict[str, list[Sequence[Any]]] = {}
    for name, history in (item for each in histories for item in each.items()):
        known = found.setdefault(name, [])
        known += [[date, value] for date, value in history if value not in [old for _, old in known]]
    return found


def set_after(history: History, value: Any) -> tuple[str, Sequence[Any]]:
    """Return when a value was set after the result was known, and what stood before; no date where it was not."""
    values = [old for _, old in history]
    place = values.index(value) if value in values else 0
    return (str(history[place][0]), values[:place]) if place else ("", ())


@dataclass(frozen=True)
class Kept:
    """One bound.

    Attributes:
        metric: Name of the metric.
        bound: Where it has to lie.
        share: The repetitions that keep it; None where the run has no such metric.
        history: The bounds of this metric over time; empty where it is that with which the run was made.
    """

    metric: str
    bound: Bound
    share: "Share | None"
    history: History = ()

    @property
    def failing(self) -> "Share | None":
        """The repetitions that do not keep it."""
        return None if self.share is None else self.share.rest


@dataclass(frozen=True)
class Spec:
    """The bounds of a run, and how often they are kept.

    Attributes:
        bounds: Each bound, in the order of the spec.
        whole: The repetitions that keep all bounds; None where the run lacks one of the metrics.
    """

    bounds: tuple[Kept, ...]
    whole: "Share | None"

    @property
    def failing(self) -> "Share | None":
        """The repetitions that do not keep all bounds."""
        return None if self.whole is None else self.whole.rest

    @property
    def config(self) -> dict[str, Bound]:
        """The bounds of the config by metric."""
        return {one.metric: one.bound for one in self.bounds}

    @property
    def lacking(self) -> list[str]:
        """Names of the metrics that the run has none of."""
        return [one.metric for one in self.bounds if one.share is None]

    def record(self) -> dict[str, Any]:
        """Return the stored record: ends and proportion of each bound, and the proportion that keeps all."""
        bounds = {one.metric: {**one.bound.model_dump(), **_record(one.share)} for one in self.bounds}
        return {"bounds": bounds, "all": _record(self.whole)}


def bounds_of(config: Mapping[str, Any]) -> dict[str, Bound]:
    """Return the bounds by metric of a checked config; none of one from before there were any."""
    stored = config.get("spec", {}).get("metrics", {})
    return {metric: Bound.model_validate(bound) for metric, bound in stored.items()}


def judge(
    bounds: Mapping[str, Bound],
    repetitions: int,
    metrics: Mapping[str, Any],
    values: Callable[[str], FloatArray],
    exact: bool,
) -> Spec:
    """Return the number of a run's repetitions that keep some bounds.

    One that failed, or has no value, as it never settled, does not keep its bound.

    Args:
        bounds: The bounds by metric, one or more.
        repetitions: Number of repetitions.
        metrics: Metrics of the run; empty if every repetition failed.
        values: Gives one of these in each repetition, shape (repetitions,), NaN where it has no value.
        exact: True if nothing is drawn: all repetitions are the same.
    """
    kept: dict[str, NDArray[np.bool_] | None] = {}
    for metric, bound in bounds.items():
        if metric in metrics:
            kept[metric] = bound.range.holds(values(metric))
        else:
            kept[metric] = None if metrics else np.zeros(repetitions, dtype=bool)
    there = [one for one in kept.values() if one is not None]
    whole = _count(np.logical_and.reduce(there), exact) if len(there) == len(kept) else None
    shares = {metric: None if one is None else _count(one, exact) for metric, one in kept.items()}
    return Spec(tuple(Kept(metric, bound, shares[metric]) for metric, bound in bounds.items()), whole)


def read_spec(record: Mapping[str, Any]) -> Spec:
    """Return the specification that `Spec.record` stored."""
    bounds = []
    for metric, stored in record["bounds"].items():
        bound = Bound(min=stored["min"], max=stored["max"], reason=stored["reason"])
        bounds.append(Kept(metric, bound, _share(stored), record.get("history", {}).get(metric, ())))
    return Spec(tuple(bounds), _share(record["all"]))


def _count(kept: NDArray[np.bool_], exact: bool) -> "Share":
    from runner.statistics.proportion import count_share  # SciPy, a second, which runs without bounds do without

    return count_share(int(np.count_nonzero(kept)), kept.size, exact)


def _record(share: "Share | None") -> dict[str, float | None]:
    if share is None:
        return dict.fromkeys(("kept", "of", "share", "low", "high"))
    return {"kept": share.kept, "of": share.of, "share": share.share, "low": share.low, "high": share.high}


def _share(stored: Mapping[str, Any]) -> "Share | None":
    from runner.statistics.proportion import Share

    return None if stored["kept"] is None else Share(*(stored[key] for key in ("kept", "of", "low", "high")))


@dataclass(frozen=True)
class Verdict:
    """Result of the repetitions for a bound.

    Attributes:
        says: Kept, broken, or too few repetitions.
        needed: How many repetitions in all would tell, where these do not and the share stays what it is; None where
            no number would, or these do.
    """

    says: Literal["kept", "broken", "untold"]
    needed: int | None = None


def judge_share(share: "Share", at_most: float | None) -> Verdict:
    """Return the result of the repetitions.

    Args:
        share: Those that keep the bound.
        at_most: The largest probability of failing that is allowed, above 0 and below 1; the whole 95 % interval has
            to lie below it. None where no repetition may fail: nothing is said of the probability then.
    """
    if at_most is None:
        return Verdict("kept" if share.kept == share.of else "broken")
    failing = share.rest
    if failing.high < at_most:
        return Verdict("kept")
    if failing.low > at_most:
        return Verdict("broken")
    from runner.statistics.proportion import needed_repetitions

    return Verdict("untold", needed_repetitions(failing, at_most))
