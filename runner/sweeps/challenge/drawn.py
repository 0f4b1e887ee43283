"""Draws of a side of a challenge: the metric in each, and the draws in which the side does not work."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.base.dotted_keys import get
from runner.schema.bound import Bound
from runner.statistics import compare_paired
from runner.statistics.paired import PairedComparison
from runner.statistics.scope import TriedVariation
from runner.store.drawn import draws_nothing
from runner.store.run import Run

_ERROR = "max_tracking_error"
_SATURATION = "saturation_fraction"
_SHARE = {"did_not_follow": 0.25, "saturation": 0.1}  # thresholds of configs without these rules

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Drawn:
    """Draws of one side.

    Attributes:
        values: The metric in each draw, shape (n,); infinite if it is beyond every number.
        lost: True for a draw that fails or does not follow the motion, shape (n,).
        spoilt: True also for a draw with a saturated joint or a broken spec, shape (n,).
        exact: True if nothing is drawn.
        has_metric: False if the run has no such metric.
    """

    values: FloatArray
    lost: Mask
    spoilt: Mask
    exact: bool
    has_metric: bool = True


def read_drawn(run: Run, metric: str) -> Drawn:
    """Return the draws of a stored run."""
    count = run.repetitions
    metrics = {name: run.values(name) for name in run.record["metrics"]}
    failed = np.full(count, run.status == "failed" and not metrics)
    if metrics:
        failed |= np.isnan(np.stack(list(metrics.values()))).all(axis=0)
    lost = failed | _does_not_follow(run, metrics, count)
    spoilt = lost | _is_saturated(run, metrics, count) | _breaks_spec(run, metrics, count)
    known = metrics.get(metric, np.full(count, np.nan))
    values = np.where(np.isnan(known), np.inf, known)
    return Drawn(values, lost, spoilt, draws_nothing(run.config), metric in metrics or run.status == "failed")


def join(parts: "list[Drawn]") -> Drawn:
    """Return the draws of several blocks as one."""
    return Drawn(
        np.concatenate([part.values for part in parts]),
        np.concatenate([part.lost for part in parts]),
        np.concatenate([part.spoilt for part in parts]),
        all(part.exact for part in parts),
        all(part.has_metric for part in parts),
    )


def compare_drawn(a: Drawn, b: Drawn, error: float | None) -> TriedVariation:
    """Return a variation as it was simulated.

    Args:
        a: Draws of A.
        b: Draws of B, in the same order.
        error: Integration error in the difference; None if it is unknown.
    """
    if not (a.has_metric and b.has_metric):
        return TriedVariation(None, "the runs have no such metric")
    shares = [(float(np.mean(of_a)), float(np.mean(of_b))) for of_a, of_b in ((a.lost, b.lost), (a.spoilt, b.spoilt))]
    if np.isinf(a.values).all() and np.isinf(b.values).all() and not min(shares[0]):
        return TriedVariation(None, "neither side has a value")
    found = compare_paired(a.values, b.values)
    exact = a.exact and b.exact
    return TriedVariation(
        PairedComparison(found.a, found.b, found.differences, error, exact=exact), "", shares[0], shares[1]
    )


def _does_not_follow(run: Run, metrics: dict[str, FloatArray], count: int) -> Mask:
    """Return the draws of the caveat `did_not_follow`, whose value is that of the worst draw.

    The share of another draw follows from its largest error; without that metric all draws count.
    """
    worst = next((float(caveat["value"]) for caveat in run.caveats if caveat["rule"] == "did_not_follow"), None)
    if worst is None:
        return np.zeros(count, dtype=bool)
    errors = metrics.get(_ERROR)
    if errors is None or not np.nanmax(errors, initial=0.0) > 0.0:
        return np.ones(count, dtype=bool)
    shares = worst * np.nan_to_num(errors, nan=np.inf) / float(np.nanmax(errors))
    return np.asarray(shares > _threshold(run, "did_not_follow"))


def _is_saturated(run: Run, metrics: dict[str, FloatArray], count: int) -> Mask:
    shares = [values for name, values in metrics.items() if name.startswith(f"{_SATURATION}_q")]
    if not shares:
        return np.zeros(count, dtype=bool)
    return np.asarray(np.nan_to_num(np.stack(shares)).max(axis=0) > _threshold(run, "saturation"))


def _breaks_spec(run: Run, metrics: dict[str, FloatArray], count: int) -> Mask:
    broken = np.zeros(count, dtype=bool)
    for name, bound in (get(run.config, "spec.metrics") or {}).items():
        if name in metrics:
            broken |= ~Bound.model_validate(bound).range.holds(metrics[name])
    return broken


def _threshold(run: Run, rule: str) -> float:
    value = get(run.config, f"caveats.{rule}.share")
    return _SHARE[rule] if value is None else float(value)
