"""Agreement of the plants on a controlled motion."""

import math
from collections.abc import Mapping

import numpy as np

from runner.store import Run
from runner.studies.engines.figures import measured, tip_distance, tracking_error
from runner.study.measured import Measured
from runner.study.prose.patterns import found


def plant_step(run: Run) -> float:
    """Return the step by which a run's plant was simulated, in ms."""
    return 1000.0 * float(run.provenance["plant_step"])


def tracking_error_apart(runs: Mapping[str, Run], plant: str, other: str) -> list[Measured]:
    """Return the difference of the largest axis errors on two plants on each arm, as a share."""
    return [
        Measured(f"{plant} from {other}, {arm}", _apart(one.run, runs[f"closed/{arm}/{other}"]))
        for one in found(runs, f"closed/{{arm}}/{plant}")
        for arm in (one.levels["arm"],)
    ]


def distances(runs: Mapping[str, Run], plant: str, other: str) -> list[Measured]:
    """Return the largest distance of the tips on two plants on each arm, in m."""
    return [
        measured(f"{plant} from {other}, {arm}", tip_distance, "m", one.run, runs[f"closed/{arm}/{other}"])
        for one in found(runs, f"closed/{{arm}}/{plant}")
        for arm in (one.levels["arm"],)
    ]


def common_digits(run: Run, other: Run) -> str:
    """Return how many digits of the largest axis error two runs have in common, as a cell of a table."""
    off = _apart(run, other)
    return "all" if off == 0.0 else "–" if math.isnan(off) else str(max(math.floor(-math.log10(off)), 0))


def _apart(run: Run, other: Run) -> float:
    values = [tracking_error(each) for each in (run, other)]
    first, second = (np.nan if value is None else value for value in values)
    return abs(first / second - 1.0)
