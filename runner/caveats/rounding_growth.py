"""Growth of rounding errors: comparison of a run with the same run from a start moved by one rounding error.

Another processor rounds some operations differently. In most runs these differences keep the size of rounding errors.
They grow in limit cycles and falls, and jump at steps, such as those of an encoder. Then they determine some metrics.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from runner.base import machine
from runner.base.arrays import FloatArray
from runner.base.quantities import ROUNDING
from runner.base.trace import Trace

STEP = 2.0**-52
"""Displacement of each joint at the start, in rad or m: the distance from 1 to the next number in double precision."""

SENSITIVE = machine.ROUNDING
"""Relative change of a metric above which it is sensitive to rounding, as in `runner check`."""

Metrics = Mapping[str, float | None]


@dataclass(frozen=True)
class RoundingGrowth:
    """Changes of repetition 0 of a run through a moved start.

    Attributes:
        factor: Ratio of the largest difference of a joint position to that at the start.
        at: Time of the largest difference, in s.
        failures: Times at which the run fails, and the run from the moved start, in s; None if it does not fail.
        metrics: Relative change of each metric; see `relative_change`.
    """

    factor: float
    at: float
    failures: tuple[float | None, float | None]
    metrics: Mapping[str, float]

    @property
    def largest(self) -> float:
        """The largest relative change, of a metric or of the time of the failure."""
        return max([relative_change(*self.failures), *self.metrics.values()])

    def record(self) -> dict[str, Any]:
        """Return the content for metrics.json."""
        return {**asdict(self), "failures": list(self.failures)}


def move_start(q: FloatArray, signs: FloatArray) -> FloatArray:
    """Return joint positions, each moved by STEP, or to the next number in double precision if that is farther.

    Args:
        q: Joint positions, shape (nq,), in rad or m.
        signs: Direction of each joint, -1 or 1, shape (nq,).
    """
    moved: FloatArray = q + signs * np.maximum(STEP, np.spacing(np.abs(q)))
    return moved


def compare(trace: Trace, metrics: Metrics, other: Trace, others: Metrics) -> RoundingGrowth:
    """Compare a run with the same run from a moved start.

    Args:
        trace: Trace of the run.
        metrics: Metrics of the run; empty if it failed.
        other: Trace from the moved start.
        others: Metrics from the moved start; empty if that run failed.
    """
    rows = min(len(trace.t), len(other.t))
    with np.errstate(over="ignore", invalid="ignore"):  # of two runs that diverge
        difference = np.abs(trace.q[:rows] - other.q[:rows]).max(axis=1)
    finite = np.flatnonzero(np.isfinite(difference))  # the last positions of a diverging run can be infinite or NaN
    farthest = finite[difference[finite].argmax()]
    first, second = (None if each.failure is None else each.failure.time for each in (trace, other))
    return RoundingGrowth(
        factor=float(difference[farthest]) / max(float(difference[0]), STEP),
        at=float(trace.t[farthest]),
        failures=(first, second),
        metrics={name: relative_change(value, others.get(name)) for name, value in metrics.items()},
    )


def relative_change(a: float | None, b: float | None) -> float:
    """Return the difference of two values as a fraction of the larger one, at most 1.

    It is 0 for differences of the size of rounding errors, and 1 if only one of the values is missing.
    """
    if a is None or b is None:
        return float(a is not b)
    difference = abs(a - b)
    return 0.0 if difference <= ROUNDING else min(1.0, difference / max(abs(a), abs(b)))
