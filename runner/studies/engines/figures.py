"""Arm names and unrounded numbers for the chapters of the engines study."""

from collections.abc import Callable

from runner.base.quantities import number
from runner.reporting.figures import model_of
from runner.store import Run
from runner.studies.engines.side_by_side import difference, mujoco_of
from runner.study.measured import Measured
from runner.study.run_values import distance, median

Told = Callable[..., float | None]


def arm_words() -> dict[str, str]:
    """Return what the arms are called."""
    return {
        "macro": "Macro",
        "mini": "Mini",
        "combined": "Mini on Macro",
        "macro_mini_mini": "Mini on Mini on Macro",
        "xarm7": "xArm7",
        "xarm7_mini": "Mini on xArm7",
        "meca500": "Meca500",
        "planar": "two links in a plane",
        "scara": "SCARA",
        "seven": "seven joints",
    }


def exact(what: Told, digits: int = 2) -> Callable[..., str]:
    """Return a number as a cell of a table that keeps what elsewhere counts as rounding, and zeros at the end."""
    return lambda *runs: number(what(*runs), digits, zeros=True)


def tracking_error(run: Run) -> float | None:
    """Return the largest axis error of a run, in m."""
    return median(run, "max_axis_error")


def tip_distance(run: Run, reference: Run) -> float:
    """Return the largest distance of the tips of two runs at their common times, in m."""
    return float(distance(run, reference, "tip").max())


def measured(words: str, what: Told, unit: str, *runs: Run) -> Measured:
    """Return what a function gives for some runs as a measured value; none where one of them failed."""
    failed = any(run.status == "failed" for run in runs)
    return Measured(words, None if failed else what(*runs), unit)


def share_of(run: Run, other: Run, reference: Run) -> float:
    """Return how far a run is from another one, as a share of how far it is from a reference."""
    return tip_distance(run, other) / tip_distance(run, reference)


def cost(run: Run) -> float:
    """Return the median time that a tick took, over the time that it simulates."""
    return float(run.record["timing"]["tick_time_median"]) / float(run.config["controller"]["period"])


def acceleration_off(run: Run) -> float:
    """Return how far a MuJoCo run's accelerations are from Pinocchio's at random states at most, as a share."""
    return difference(model_of(run), mujoco_of(run)).acceleration
