"""Integration error and computing time of each plant by step, and the benefit of smaller steps."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from runner.papers.studies.precision.measure import FILE, PLANT, load
from runner.papers.study.results import MissingError, Runs, matching_runs
from runner.store import Run

BY_PINOCCHIO, COMPILED = "Runge-Kutta, Pinocchio", "Runge-Kutta, compiled"
PLANTS = ("PyBullet", "MuJoCo", COMPILED, BY_PINOCCHIO)
_SLACK = 1.5  # by which an error may miss falling in proportion to the step
_BAND = 0.01  # of the settling band: an error that is small enough


@dataclass(frozen=True)
class SteppedPlant:
    """A plant by one step.

    Attributes:
        step: The step, in s.
        joints: Largest distance of a joint from the solution, in rad; NaN of a run that failed.
        tip: That of the tip, in m.
        seconds: Median computing time of a tick times the number of ticks, in s.
    """

    step: float
    joints: float
    tip: float
    seconds: float


def by_steps(runs: Runs, case: str, arm: str, plant: str) -> list[SteppedPlant]:
    """Return a plant by its steps, the largest first."""
    kept = solutions(runs)[f"{case}/{arm}"]
    if plant == BY_PINOCCHIO:
        return [SteppedPlant(float(step), **own) for step, own in kept["interpreted"].items()]
    name = PLANT if plant == COMPILED else plant
    tried = []
    for one in matching_runs(runs, f"{case}/{arm}/{{plant={name}}}/{{step}}"):
        step = one.levels["step"]
        if one.run.status == "failed":
            tried.append(SteppedPlant(float(step), np.nan, np.nan, np.nan))
            continue
        joints = np.abs(one.run.joints("q") - np.array(kept["q"])).max()
        tip = np.linalg.norm(one.run.vector("tip") - np.array(kept["tip"]), axis=1).max()
        seconds = kept["compiled_seconds"][step] if plant == COMPILED else _seconds(one.run)
        tried.append(SteppedPlant(float(step), float(joints), float(tip), seconds))
    return tried


def order(tried: list[SteppedPlant]) -> float | None:
    """Return the power of the step with which the joint error falls between the two largest steps; None for none."""
    first, second, *_ = tried
    power = np.log(first.joints / second.joints) / np.log(first.step / second.step)
    return None if np.isnan(power) else float(power)


def knee(tried: list[SteppedPlant]) -> SteppedPlant | None:
    """Return the step below which the joint error no longer falls in proportion to it; None where it always does."""
    for one, smaller in pairwise(tried):
        if not smaller.joints <= _SLACK * one.joints * smaller.step / one.step:
            return one
    return None


def allowed_error(runs: Runs, case: str, arm: str) -> float:
    """Return the error of the tip that is taken as small enough, in m."""
    run = matching_runs(runs, f"{case}/{arm}/{{plant={PLANT}}}/{{step}}")[0].run
    return _BAND * float(run.config["robot"]["settling_band"])


def solutions(runs: Runs) -> Mapping[str, Any]:
    """Return the solution of each case and arm, stored next to the runs, with the additions of measure.py.

    Raises:
        MissingError: if there are none, or those of other runs.
    """
    path = next(iter(runs.values())).folder.parent.parent / FILE
    record = _loaded(path, path.stat().st_mtime_ns) if path.is_file() else None
    if record is None or any(runs[name].hash != of for name, of in record["runs"].items()):
        raise MissingError(f"{FILE}: not computed for these runs; runner reproduce precision does it")
    cases: Mapping[str, Any] = record["cases"]
    return cases


@lru_cache(maxsize=2)
def _loaded(path: Path, _written: int) -> dict[str, Any] | None:
    return load(path)


def _seconds(run: Run) -> float:
    return float(run.record["timing"]["tick_time_median"]) * (len(run.t) - 1)
