"""Caveat on the integration error of the plant."""

from typing import NamedTuple

from runner.caveats.integration_error import PARTED, PLANT, PlantError, sufficient_step
from runner.caveats.rule import Caveat, percent
from runner.plugins.metric_units import unit_of
from runner.schema.bound import Range

NAME = "plant_error"
_OF_BAND = 0.01  # of the settling band; smaller differences are ignored


class PlantStep(NamedTuple):
    """Integration step that the rule checks.

    Attributes:
        plant: Kind of the plant.
        step: Integration step of the plant, in s.
        period: The fastest control period, in s.
        band: Settling band of the robot, in m.
    """

    plant: str
    step: float
    period: float
    band: float


def caveat_of(error: PlantError, own: PlantStep, threshold: float) -> Caveat | None:
    """Return the caveat on the integration error of a run; None if the error is small enough.

    The rule is triggered, with the value 1, if the motions part. It is also triggered by the relative error of a metric
    in m whose difference exceeds a hundredth of the settling band. Errors of other metrics are only stored and shown,
    such as a peak torque at a single tick, or a settling time, which changes by whole ticks.

    Args:
        error: Integration error of the run.
        own: Integration step of the run.
        threshold: Allowed relative error of a metric.
    """
    allowed = Range(high=threshold)
    if error.parted is not None:
        return Caveat(NAME, _parted(error, own), 1.0) if allowed.exceeded(1.0) else None
    shares = {
        name: worth.share
        for name, worth in error.metrics.items()
        if unit_of(name) == "m" and worth.share is not None and (worth.difference or 0.0) > _OF_BAND * own.band
    }
    worst = max(shares, key=shares.__getitem__, default=None)
    if worst is None or not allowed.exceeded(shares[worst]):
        return None
    return Caveat(NAME, _told(worst, shares[worst], own, threshold), shares[worst])


def _told(metric: str, share: float, own: PlantStep, threshold: float) -> str:
    enough = sufficient_step(own.step, share, threshold, own.period)
    smaller = "" if enough is None else f"plant.step={enough:.6g} would make it {percent(threshold)} or less, or "
    return (
        f"the integration step of {own.plant}, {own.step:g} s, contributes {percent(share)} of {metric}: {smaller}"
        f"plant={PLANT} would make it negligible"
    )


def _parted(error: PlantError, own: PlantStep) -> str:
    found = f"{own.plant} in steps of {own.step:g} s and {PLANT} part at t = {error.parted:.4g} s"
    fails = f"on {PLANT} the run fails: {error.failure}"
    if error.largest is not None and error.largest > PARTED * own.band:
        apart = f"their tips are {error.largest:.3g} m apart at most, and {error.end:.3g} m at the end"
        told = f"{found}: {apart}; what is measured after that is one of several outcomes"
        return f"{told}; {fails}" if error.failure else told
    return f"{found}: {fails}" if error.failure else f"{found}, where this run fails and that on {PLANT} does not"
