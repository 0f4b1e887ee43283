"""Distance of runs on other plants from the same run on the Runge-Kutta plant."""

from collections.abc import Callable, Mapping

import numpy as np

from runner.reporting.figures import joint_columns
from runner.store import Run
from runner.study.measured import Measured
from runner.study.prose.patterns import found


def final_difference(run: Run, reference: Run) -> float:
    """Return the distance of the joint positions at the end of two runs, in rad."""
    last, final = (joint_columns(each.trace, "q")[-1] for each in (run, reference))
    return float(np.linalg.norm(last - final))


def to_step_before(runs: Mapping[str, Run]) -> Callable[[Run], str]:
    """Return what gives the difference of a run over that of the one before it, with twice its step, for a table."""
    reference = runs["plants/rk4"]
    tried = [one.run for one in found(runs, "plants/{step}") if one.run is not reference]

    def ratio(run: Run) -> str:
        before = tried[tried.index(run) - 1]
        return f"{final_difference(run, reference) / final_difference(before, reference):.3f}"

    return ratio


def proportional(value: Measured, at: float) -> Callable[[float], float | None]:
    """Return the law that goes with its argument and has a value at one place."""
    return lambda x: None if value.value is None else value.value * x / at
