"""Stability limits with delayed and missed commands, and computing times of controllers."""

from collections.abc import Callable, Mapping

import numpy as np

from runner.controllers.force.force_stability import delay_limit, miss_limit, pattern_limit
from runner.reporting.document import Series
from runner.store import Run
from runner.study.prose.patterns import found
from runner.study.run_values import clock

_TOP = 1.0  # m, of the lines in figures
_LOW = 1e-5


def rate(run: Run) -> float:
    """Return omega_n h of a run with one loop."""
    law = run.config["controller"]
    return float(law["natural_frequency"]) * float(law["period"])


def diverges(run: Run) -> bool:
    """Tell whether a run diverged."""
    return run.status == "failed"


def bears(run: Run) -> float:
    """Return the largest omega_n h that the delay, or the pattern of misses, of a run bears by the closed form."""
    computation = run.config["plant"]["computation"]
    pattern = computation["miss"]
    return pattern_limit(sum(pattern)) if isinstance(pattern, list) else delay_limit(int(computation["delay"]))


def limit_of(runs: Mapping[str, Run], run: str) -> float:
    """Return the same of a run by name."""
    return bears(runs[run])


def as_predicted(run: Run) -> bool:
    """Tell whether a run diverges, or not, as the closed form says."""
    return diverges(run) == (rate(run) > bears(run))


def counted(run: Run) -> bool:
    """Tell that a run is there."""
    return True


def limits(runs: Mapping[str, Run], pattern: str) -> list[Series]:
    """Return an upright line at the limit of each of some runs, which differ in it alone, as long as the axis."""
    bounds = {bears(one.run): None for one in found(runs, pattern)}
    ends = np.array([_LOW, _TOP])
    return [Series("", np.array([at, at]), ends, "dotted", color=color) for color, at in enumerate(bounds)]


def miss_limits(runs: Mapping[str, Run], pattern: str) -> list[Series]:
    """Return an upright line at the probability of a miss that each rate bears in the mean square."""
    bounds = {round(miss_limit(rate(one.run)), 9): None for one in found(runs, pattern)}
    ends = np.array([_LOW, _TOP])
    return [Series("", np.array([at, at]), ends, "dotted", color=color) for color, at in enumerate(bounds)]


def borne(run: Run) -> float:
    """Return the probability of a miss that a run's rate bears in the mean square."""
    return miss_limit(rate(run))


def fastest(run: Run) -> float:
    """Return the fastest period of a run, in s."""
    t = clock(run)
    return float(t[1] - t[0])


def laws_took(name: str) -> Callable[[Run], float]:
    """Return a function of a run that gives a time of its laws in a tick, in us; NaN where nobody told."""

    def took(run: Run) -> float:
        seconds = run.record["timing"].get(name)
        return float("nan") if seconds is None else 1e6 * float(seconds)

    return took


def load(run: Run) -> float:
    """Return the machine's load average after a run; NaN where nobody told."""
    return float(run.record["timing"].get("load_average", float("nan")))
