"""Arm names and unrounded numbers for the chapters of the engines study."""

import math
from collections.abc import Callable

import numpy as np

from runner.base.quantities import number
from runner.store import Run
from runner.studies.engines.side_by_side import difference, mujoco_of
from runner.study.measured import Measured
from runner.study.prose.blocks import of_run
from runner.study.prose.signals import distance
from runner.study.results import Runs, found

Told = Callable[..., float | None]


def exact(what: Told, digits: int = 2) -> Callable[..., str]:
    """Return a number as a cell of a table that keeps what elsewhere counts as rounding, and zeros at the end."""
    return lambda *runs: number(what(*runs), digits, zeros=True)


def tip_distance(run: Run, reference: Run) -> float:
    """Return the largest distance of the tips of two runs at their common times, in m."""
    return float(distance("tip")(run, reference).max())


def share_of(run: Run, other: Run, reference: Run) -> float:
    """Return the distance of a run from another one over its distance from a reference."""
    return tip_distance(run, other) / tip_distance(run, reference)


def acceleration_off(run: Run) -> float:
    """Return the largest relative difference of a MuJoCo run's accelerations from Pinocchio's at random states."""
    return difference(run.model, mujoco_of(run)).acceleration


def order(coarse: Run, fine: Run, reference: Run) -> float:
    """Return the power of its step with which a plant comes to a reference, from one step to half of it."""
    return math.log2(tip_distance(coarse, reference) / tip_distance(fine, reference))


def orders(runs: Runs, coarse: str, fine: str, *plants: str) -> list[Measured]:
    """Return the order of some plants on each arm, from one step to half of it."""
    return [
        of_run(runs, f"order of {plant}, {arm}", order, "1", f"{own}/{coarse}", f"{own}/{fine}", reference)
        for plant in plants
        for arm, reference in _arms(runs)
        for own in [f"open/{arm}/{plant}"]
    ]


def apart_as_share(runs: Runs, plant: str, other: str) -> list[Measured]:
    """Return the distance of a plant from another one at 1 ms on each arm, relative to its error."""
    return [
        of_run(runs, f"{plant} from {other}, {arm}", share_of, "1", *names, reference)
        for arm, reference in _arms(runs)
        for names in [(f"open/{arm}/{plant}/0.001", f"open/{arm}/{other}/0.001")]
    ]


def _arms(runs: Runs) -> list[tuple[str, str]]:
    """Return the name of each arm in the runs, and that of its reference."""
    return [(one.levels["arm"], one.name) for one in found(runs, "reference/{arm}/rk4/5e-05")]


def tracking_error_apart(runs: Runs, plant: str, other: str) -> list[Measured]:
    """Return the relative difference of the largest axis errors on two plants, on each arm."""
    return [
        Measured(f"{plant} from {other}, {arm}", _apart(one.run, runs[f"closed/{arm}/{other}"]))
        for one in found(runs, f"closed/{{arm}}/{plant}")
        for arm in (one.levels["arm"],)
    ]


def distances(runs: Runs, plant: str, other: str) -> list[Measured]:
    """Return the largest distance of the tips on two plants on each arm, in m."""
    return [
        of_run(runs, f"{plant} from {other}, {arm}", tip_distance, "m", one.name, f"closed/{arm}/{other}")
        for one in found(runs, f"closed/{{arm}}/{plant}")
        for arm in (one.levels["arm"],)
    ]


def common_digits(run: Run, other: Run) -> str:
    """Return the number of equal digits in the largest axis errors of two runs, as a cell of a table."""
    off = _apart(run, other)
    return "all" if off == 0.0 else "–" if math.isnan(off) else str(max(math.floor(-math.log10(off)), 0))


def _apart(run: Run, other: Run) -> float:
    values = [each.median("max_axis_error") for each in (run, other)]
    first, second = (np.nan if value is None else value for value in values)
    return abs(first / second - 1.0)
