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

PLANT = "rk4"
"""The plant that others are held against."""
COMPARED = ("bullet", "mujoco")
PARTED = 4.0
"""Settling bands between the tips beyond which two motions have parted. In runs of studies the tips come up to 3 bands
apart where no torque is at its limit, and 4.9 or more, mostly 10 to 55, where the motion takes another way."""
_WALL = "it is of fourth order in smooth motion alone, and here the tip may meet a wall"
_NOT_OF_RK4 = ("integrator", "min_inertia", "in_place_of")

Metrics = Mapping[str, float | None]


@dataclass(frozen=True)
class ErrorEstimate:
    """What the step is worth in one metric.

    Attributes:
        value: The metric on Runge-Kutta; None where it has none.
        difference: How far the run's value is from that, in the metric's unit; None where the two are not comparable:
            the motions part, or one of them has no value.
        share: The difference over the run's value; None as above, and where the run's value alone is 0.
    """

    value: float | None
    difference: float | None = None
    share: float | None = None


@dataclass(frozen=True)
class PlantError:
    """What the plant's step is worth in repetition 0 of a run.

    Attributes:
        step: Step of the Runge-Kutta plant, in s; None where it cannot make the run.
        reason: Why it cannot, in words; empty where it can.
        largest: Largest distance between the tips at equal times, in m, where both are finite; None as above, and so
            are the others.
        at: When, in s.
        end: Distance between the tips at the end, likewise.
        parted: When the motions part, in s: the tips are farther apart than PARTED settling bands, or one of the runs
            fails where the other does not; None where they never do. From then on each goes a way of its own, and the
            difference of a metric is no longer an error of integration.
        failure: Why the run on Runge-Kutta failed; empty where it did not.
        metrics: What the step is worth in each metric.
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
        """Return what metrics.json holds of it."""
        if self.step is None:
            return {"plant": PLANT, "reason": self.reason}
        kept = {key: value for key, value in asdict(self).items() if key != "reason" and (key != "failure" or value)}
        return {"plant": PLANT, **kept}


def reason_not_comparable(environment: str) -> str:
    """Return why Runge-Kutta is no measure of a run in an environment, given by its kind; empty where it is."""
    return _WALL if environment == "wall" else ""


def on_runge_kutta(resolved: Mapping[str, Any]) -> dict[str, Any]:
    """Return the config of the same run on the Runge-Kutta plant, in its default step: repetition 0 alone."""
    plant = {key: value for key, value in resolved["plant"].items() if key not in _NOT_OF_RK4}
    plant |= {"kind": PLANT, "step": None}
    return {**resolved, "plant": plant, "repetitions": 1, "plant_error": False}


def compare(trace: Trace, metrics: Metrics, other: Trace, others: Metrics, band: float, step: float) -> PlantError:
    """Hold a run against the same run on Runge-Kutta.

    Args:
        trace: The run's trace.
        metrics: Its metrics; none where it failed.
        other: The trace on Runge-Kutta.
        others: The metrics there, likewise.
        band: Settling band of the robot, in m.
        step: Step of the Runge-Kutta plant, in s.
    """
    rows = min(len(trace.t), len(other.t))
    distance = np.linalg.norm(trace.tip[:rows] - other.tip[:rows], axis=1)
    parted = _parting(trace, other, distance, band)
    finite = np.flatnonzero(np.isfinite(distance))  # a run that diverges may end in none
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
    """Return a step with which the plant's share of a metric would fall to a wanted one.

    The error is of first order in the step, and is taken to be what the metric has too much: of a metric of 1 the rest,
    1 - share, stays.

    Args:
        step: The step that made the share, in s.
        share: That share, above 0.
        wanted: The share that would do, below 1.
        period: The fastest control period, in s, of which the step is a whole part.

    Returns:
        The step, in s; None where none is known, or so small a one would be slower than Runge-Kutta in any case.
    """
    enough = step * wanted * (1.0 - share) / (share * (1.0 - wanted))
    parts = period / enough if enough > 0.0 else math.inf
    return period / math.ceil(parts - 1e-9) if parts <= _MOST_PARTS else None


_MOST_PARTS = 1000  # of a period; Runge-Kutta asks for the dynamics four times
