"""Force control: rise times, effective masses, stiffest stable wall, impacts and sliding friction."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.stability import force_loop_limit
from runner.papers.study.prose.signals import along
from runner.papers.study.results import Runs, matching_runs
from runner.papers.study.run_values import delay_of
from runner.reporting.document import Series
from runner.robots.task_space import mass_along, tip_mobility
from runner.store import Run

_RISE = 3.3579  # of omega_c times the time from 10 % to 90 % of a critically damped step
_BOUNCES = 0.05  # of the force that is asked for, from which it differs at the end
_END = 20  # ticks
_push = along("external_force", "environment.normal")
"""Force of the tip on the wall at each row, in N."""


def rise_time(run: Run) -> float:
    """Return the rise time of the force from 10 % to 90 % of the desired one, in s; NaN if it never rises so far."""
    force, asked, t = _push(run), float(run.config["controller"]["force"]), run.t
    if not (force >= 0.9 * asked).any():
        return float("nan")
    low, high = (_first_at(t, force, share * asked) for share in (0.1, 0.9))
    return high - low


def closed_rise_time(run: Run) -> float:
    """Return the same of a mass on the wall under the law in continuous time, in s."""
    law, stiffness = run.config["controller"], float(run.config["environment"]["stiffness"])
    return _RISE / float(np.sqrt(stiffness * (1.0 + law["force_gain"]) / mass_at_start(run)))


def bounces(run: Run) -> bool:
    """Return True if the force does not come to rest at the desired one."""
    asked = float(run.config["controller"]["force"])
    return run.status == "failed" or bool(np.abs(_push(run)[-_END:] - asked).max() > _BOUNCES * asked)


def mass_at_start(run: Run) -> float:
    """Return the mass that the tip of what pushes has along the wall's normal where a run starts, in kg."""
    return _mass(run, 0)


def stiffest_wall(run: Run) -> float:
    """Return the stiffness up to which the sampled law of a run is stable, in N/m."""
    law = run.config["controller"]
    period = _last(law["period"])
    limit = force_loop_limit(float(law["force_gain"]), float(law["force_damping"]), delay_of(run))
    return mass_at_start(run) * (limit / period) ** 2 / (1.0 + float(law["force_gain"]))


def stiffest_of(mass: float, force_gain: float, late: int) -> Callable[[float], float]:
    """Return the stiffest wall of a mass in kg against the period in ms, in N/m, this many ticks late."""
    limit = force_loop_limit(force_gain, 1.0, late)
    return lambda period: mass * (1e3 * limit / period) ** 2 / (1.0 + force_gain)


def speed_at_touch(run: Run) -> float:
    """Return the speed of a tip at its first touch of the wall, in m/s; NaN if it does not touch it."""
    row = _touch(run)
    if row is None:
        return float("nan")
    t, tip = run.t, along("tip", "environment.normal")(run)
    return float((tip[row - 1] - tip[row]) / (t[row] - t[row - 1]))


def closed_peak(run: Run) -> float:
    """Return the same of a mass on the wall's spring, v sqrt(k m), in N; NaN where nothing is touched."""
    row, stiffness = _touch(run), float(run.config["environment"]["stiffness"])
    return float("nan") if row is None else speed_at_touch(run) * float(np.sqrt(stiffness * _mass(run, row)))


def push_over_stiffness(run: Run) -> float:
    """Return a push over the stiffness that the tip is to have, in m."""
    return float(np.linalg.norm(run.config["environment"]["force"])) / float(
        run.config["controller"]["tip_stiffness"][0]
    )


def _first_at(t: FloatArray, force: FloatArray, level: float) -> float:
    """Return when a force first comes to a level, between rows on a straight line, in s."""
    row = max(1, int(np.flatnonzero(force >= level)[0]))
    return float(np.interp(level, force[row - 1 : row + 1], t[row - 1 : row + 1]))


def _touch(run: Run) -> int | None:
    """Return the first row that touches, 1 or more; None where none does."""
    touching = np.flatnonzero(_push(run) > 0.0)
    return max(1, int(touching[0])) if len(touching) else None


def _mass(run: Run, row: int) -> float:
    q = run.joints("q")[row]
    return mass_along(
        tip_mobility(run.model, q, _first_that_pushes(run)), np.array(run.config["environment"]["normal"])
    )


def _first_that_pushes(run: Run) -> int:
    """Return the first joint of what pushes on a wall."""
    stages = run.config["robot"].get("stages")
    if not stages or run.config["controller"]["actuated_stages"] == "whole":
        return 0
    return sum(len(stage["home"]) for stage in list(stages.values())[:-1])


def _last(value: object) -> float:
    """Return a value by stage of the last stage."""
    return float(list(value.values())[-1] if isinstance(value, dict) else value)  # type: ignore[arg-type]


def walls_tried(runs: Runs, name: str, bounce: bool, color: int) -> list[Series]:
    """Return the walls on which runs come to rest, or bounce, as points: period of the law in ms, stiffness in N/m."""
    tried = [one.run for one in matching_runs(runs, "force/limit/{case}/{share}") if bounces(one.run) == bounce]
    periods = np.array([1e3 * _last(run.config["controller"]["period"]) for run in tried])
    stiffness = np.array([float(run.config["environment"]["stiffness"]) for run in tried])
    return [Series(name, periods, stiffness, "points", color=color)]


def masses_around(runs: Runs, run: str, name: str, color: int) -> list[Series]:
    """Return the mass of what pushes in each direction of the plane x = 0 where a run starts, as a curve in kg."""
    model, q = runs[run].model, runs[run].joints("q")[0]
    yields = tip_mobility(model, q, _first_that_pushes(runs[run]))
    turns = np.linspace(0.0, 2.0 * np.pi, 181)
    ways = np.array([np.zeros_like(turns), np.cos(turns), np.sin(turns)])
    masses = 1.0 / np.einsum("it,ij,jt->t", ways, yields, ways)
    return [Series(name, masses * ways[1], masses * ways[2], "line", color=color)]
