"""Integration error of a plant: comparison of a run with the same run on the Runge-Kutta plant.

PyBullet, and MuJoCo with Euler's scheme, integrate to first order in their step. Runge-Kutta integrates to fourth
order, so that its error is negligible in comparison. Repetition 0 is compared, with the same noise.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from runner.base.trace import Trace

COMPARED = ("bullet", "mujoco")
"""Plants whose integration error is estimated."""
PLANT = "rk4"
"""The plant with which others are compared."""
PARTED = 4.0
"""Distance of the tips, in settling bands, beyond which two motions have parted. In runs of studies, the distance is at
most 3 bands if no torque is at its limit, and 4.9 or more, mostly 10 to 55, if the motions take different paths."""
_WALL = "it is of fourth order only in smooth motion, and here the tip may meet a wall"
_NOT_OF_RK4 = ("integrator", "min_inertia")

Metrics = Mapping[str, float | None]


@dataclass(frozen=True)
class ErrorEstimate:
    """Integration error of one metric.

    Attributes:
        value: Value on the Runge-Kutta plant; None if it has none.
        difference: Absolute difference between the value of the run and that value, in the unit of the metric; None if
            the motions part or one of the two values is missing.
        share: Ratio of the difference to the value of the run; also None if only the value of the run is 0.
    """

    value: float | None
    difference: float | None = None
    share: float | None = None


@dataclass(frozen=True)
class PlantError:
    """Integration error of the plant in repetition 0 of a run.

    Attributes:
        step: Step of the Runge-Kutta plant, in s; None if it cannot simulate the run.
        reason: Reason why it cannot simulate the run; otherwise empty.
        largest: Largest distance between the finite tip positions at equal times, in m; None if step is None.
        at: Time of the largest distance, in s; None if step is None.
        end: Distance between the tips at the last time with finite positions, in m; None if step is None.
        parted: Time at which the motions part, in s: the distance of the tips exceeds PARTED settling bands, or only
            one of the runs fails. None if they do not part. After this time the motions are unrelated, and the
            difference of a metric is not an integration error.
        failure: Reason why the Runge-Kutta run failed; empty if it did not fail.
        metrics: Integration error of each metric.
    """

    step: float | None
    reason: str = ""
    largest: float | None = None
    at: float | None = None
    end: float | None = None
    parted: float | None = None
    failure: str = ""
    metrics: Mapping[str, ErrorEstimate] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """Return the content for metrics.json."""
        if self.step is None:
            return {"plant": PLANT, "reason": self.reason}
        kept = {key: value for key, value in asdict(self).items() if key != "reason" and (key != "failure" or value)}
        return {"plant": PLANT, **kept}


def reason_not_comparable(environment: str) -> str:
    """Return the reason why Runge-Kutta is not comparable in a kind of environment; empty if it is comparable."""
    return _WALL if environment == "wall" else ""


def on_runge_kutta(resolved: Mapping[str, Any]) -> dict[str, Any]:
    """Return the config of repetition 0 of the same run on the Runge-Kutta plant with its default step."""
    plant = {key: value for key, value in resolved["plant"].items() if key not in _NOT_OF_RK4}
    plant |= {"kind": PLANT, "step": None}
    return {**resolved, "plant": plant, "repetitions": 1, "plant_error": False}


def compare(trace: Trace, metrics: Metrics, other: Trace, others: Metrics, band: float, step: float) -> PlantError:
    """Compare a run with the same run on the Runge-Kutta plant.

    Args:
        trace: Trace of the run.
        metrics: Metrics of the run; empty if it failed.
        other: Trace on the Runge-Kutta plant.
        others: Metrics on the Runge-Kutta plant; empty if that run failed.
        band: Settling band of the robot, in m.
        step: Step of the Runge-Kutta plant, in s.
    """
    rows = min(len(trace.t), len(other.t))
    with np.errstate(over="ignore", invalid="ignore"):  # of two runs that diverge
        distance = np.linalg.norm(trace.tip[:rows] - other.tip[:rows], axis=1)
    parted = _parting(trace, other, distance, band)
    finite = np.flatnonzero(np.isfinite(distance))  # the last positions of a diverging run can be infinite or NaN
    farthest = finite[distance[finite].argmax()]
    return PlantError(
        step=step,
        largest=float(distance[farthest]),
        at=float(trace.t[farthest]),
        end=float(distance[finite[-1]]),
        parted=parted,
        failure="" if other.failure is None else other.failure.reason,
        metrics={name: _estimate_error(value, others.get(name), parted is None) for name, value in metrics.items()},
    )


def _parting(trace: Trace, other: Trace, distance: np.ndarray, band: float) -> float | None:
    beyond = np.flatnonzero(~(distance <= PARTED * band))
    times = [float(trace.t[beyond[0]])] if len(beyond) else []
    if (trace.failure is None) != (other.failure is None):
        times += [each.failure.time for each in (trace, other) if each.failure is not None]
    return min(times, default=None)


def _estimate_error(value: float | None, other: float | None, comparable: bool) -> ErrorEstimate:
    if not comparable or value is None or other is None:
        return ErrorEstimate(other)
    difference = abs(value - other)
    return ErrorEstimate(other, difference, difference / abs(value) if value else 0.0 if difference == 0.0 else None)


def sufficient_step(step: float, share: float, wanted: float, period: float) -> float | None:
    """Return an integration step at which the relative error of a metric falls to an accepted one.

    The error is of first order in the step and is assumed to increase the metric: for a metric of 1, the value without
    error is 1 - share.

    Args:
        step: Current integration step, in s.
        share: Relative error at this step, above 0.
        wanted: Accepted relative error, below 1.
        period: The fastest control period, in s; an integer multiple of the step.

    Returns:
        The step, in s; None if no such step is known, or if it is so small that Runge-Kutta is faster.
    """
    enough = step * wanted * (1.0 - share) / (share * (1.0 - wanted))
    parts = period / enough if enough > 0.0 else math.inf
    return period / math.ceil(parts - 1e-9) if parts <= _MOST_PARTS else None


_MOST_PARTS = 1000  # steps in a period; Runge-Kutta evaluates the dynamics four times in a step
