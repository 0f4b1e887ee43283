"""Stability limits with delayed and missed commands, and computing times of controllers."""

from collections.abc import Iterable

from runner.controllers.stability import delay_limit, miss_limit, pattern_limit
from runner.papers.study.prose.plots import upright
from runner.papers.study.prose.signals import failed
from runner.papers.study.results import Runs, matching_runs
from runner.reporting.document import Series
from runner.store import Run

_TOP = 1.0  # m, of the lines in figures
_LOW = 1e-5


def rate(run: Run) -> float:
    """Return omega_n h of a run with one loop."""
    law = run.config["controller"]
    return float(law["natural_frequency"]) * float(law["period"])


def bears(run: Run) -> float:
    """Return the largest stable omega_n h under the delay, or the pattern of misses, of a run, by the closed form."""
    computation = run.config["plant"]["computation"]
    pattern = computation["miss"]
    return pattern_limit(sum(pattern)) if isinstance(pattern, list) else delay_limit(int(computation["delay"]))


def as_predicted(run: Run) -> bool:
    """Return True if a run diverges or not as the closed form predicts."""
    return failed(run) == (rate(run) > bears(run))


def limits(runs: Runs, pattern: str) -> list[Series]:
    """Return an upright line, as long as the axis, at the limit of each of some runs, which differ only in it."""
    return _upright(bears(one.run) for one in matching_runs(runs, pattern))


def miss_limits(runs: Runs, pattern: str) -> list[Series]:
    """Return an upright line at the probability of a miss up to which each rate is stable in the mean square."""
    return _upright(round(miss_limit(rate(one.run)), 9) for one in matching_runs(runs, pattern))


def _upright(places: Iterable[float]) -> list[Series]:
    return [line for color, at in enumerate(dict.fromkeys(places)) for line in upright(at, _LOW, _TOP, color=color)]


def borne(run: Run) -> float:
    """Return the probability of a miss up to which a run's rate is stable in the mean square."""
    return miss_limit(rate(run))


def fastest(run: Run) -> float:
    """Return the fastest period of a run, in s."""
    t = run.t
    return float(t[1] - t[0])
