"""Comparisons of two plants for the chapters of the engines study."""

import math

import numpy as np

from runner.papers.studies.engines.same_arm import difference, mujoco_of
from runner.papers.study.prose.signals import distance, largest_of
from runner.store import Run


def share_of(run: Run, other: Run, reference: Run) -> float:
    """Return the distance of a run's tip from another one's over its distance from a reference."""
    apart = largest_of(distance())
    return float(apart(run, other) / apart(run, reference))


def acceleration_off(run: Run) -> float:
    """Return the largest relative difference of a MuJoCo run's accelerations from Pinocchio's at random states."""
    return difference(run.model, mujoco_of(run))["acceleration"]


def error_apart(run: Run, other: Run) -> float:
    """Return the relative difference of the largest axis errors of two runs."""
    first, second = (each.median("max_axis_error") for each in (run, other))
    return np.nan if first is None or second is None else abs(first / second - 1.0)


def common_digits(run: Run, other: Run) -> str:
    """Return the number of equal digits in the largest axis errors of two runs, as a cell of a table."""
    off = error_apart(run, other)
    return "all" if off == 0.0 else "–" if math.isnan(off) else str(max(math.floor(-math.log10(off)), 0))
