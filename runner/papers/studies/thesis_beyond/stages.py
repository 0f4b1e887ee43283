"""Three-stage arm: errors, effective masses and force bandwidths by stage."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.stability import force_loop_limit
from runner.papers.studies.thesis_beyond.force import rise_time
from runner.papers.study.results import Runs
from runner.reporting.document import Series
from runner.robots.task_space import tip_mobility
from runner.store import Run

_BANDWIDTH = float(np.sqrt(np.sqrt(2.0) - 1.0))  # over omega_c, of a critically damped loop, at -3 dB
_POSTURES = 1000


def rungs(runs: Runs, run: str, name: str, color: int) -> list[Series]:
    """Return the largest axis error of each stage's end point of a run, in m, as points at 1, 2, ..."""
    errors = [runs[run].median(metric) for metric in _errors(runs[run])]
    return [Series(name, np.arange(1.0, 1.0 + len(errors)), np.array(errors), "points_line", color=color)]


def mass_of_stage(stage: int, which: int) -> Callable[[Run], float]:
    """Return the lightest (0) to heaviest (2) mass of the tip at home when a stage and all after it move, in kg."""
    return lambda run: float(1.0 / np.linalg.eigvalsh(tip_mobility(run.model, *_from(run, stage)))[2 - which])


def force_bandwidth(stage: int) -> Callable[[Run], float]:
    """Return the largest frequency of a stage's force on the stiffest stable wall of its period, in Hz."""

    def bandwidth(run: Run) -> float:
        period = float(list(run.config["controller"]["period"].values())[stage])
        return _BANDWIDTH * force_loop_limit(1.0, 1.0) / period / (2.0 * np.pi)

    return bandwidth


def least_gain(run: Run) -> float:
    """Return the least that a stage more adds to how the tip yields, over all, in random postures (Khatib)."""
    model, draw, least = run.model, np.random.default_rng(0), np.inf
    firsts = _firsts(run)
    for _ in range(_POSTURES):
        q = draw.uniform(-1.5, 1.5, model.nq)
        yields = [tip_mobility(model, q, first) for first in firsts]
        for more, less in pairwise(yields):
            gained = 0.5 * (more - less + (more - less).T)
            least = min(least, float(np.linalg.eigvalsh(gained)[0] / np.trace(more)))
    return least


def force_rise_time(run: Run) -> float:
    """Return the rise time of the force on a wall from 10 % to 90 % of the desired one, in s."""
    return rise_time(run)


def felt_by_the_tip(consistent: bool) -> Callable[[Run], float]:
    """Return the tip's acceleration under N^T tau_0 over that under tau_0, the largest in random postures.

    N^T is that of the dynamically consistent inverse, or of the plain pseudo-inverse of J^T.
    """

    def share(run: Run) -> float:
        model, draw, most = run.model, np.random.default_rng(0), 0.0
        for _ in range(_POSTURES // 10):
            q, tau = draw.uniform(-1.5, 1.5, model.nq), draw.uniform(-1.0, 1.0, model.nq)
            J, M = model.tip_jacobian(q)[:3], model.mass_matrix(q)
            yields = np.linalg.solve(M, J.T)
            back = yields @ np.linalg.inv(J @ yields) if consistent else np.linalg.pinv(J)
            left = J @ np.linalg.solve(M, tau - J.T @ (back.T @ tau))
            most = max(most, float(np.linalg.norm(left) / np.linalg.norm(J @ np.linalg.solve(M, tau))))
        return most

    return share


def _errors(run: Run) -> list[str]:
    *macros, _ = run.config["robot"]["stages"]
    return [*(f"{name}_max_axis_error" for name in macros), "max_axis_error"]


def _firsts(run: Run) -> list[int]:
    counts = [len(stage["home"]) for stage in run.config["robot"]["stages"].values()]
    return [sum(counts[:stage]) for stage in range(len(counts))]


def _from(run: Run, stage: int) -> tuple[FloatArray, int]:
    home = [angle for own in run.config["robot"]["stages"].values() for angle in own["home"]]
    return np.array(home), _firsts(run)[stage]
