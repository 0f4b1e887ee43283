"""Quantities of a run that are not metrics: joint margins, lag, saturation, sag and drift."""

from collections.abc import Callable
from functools import partial

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.papers.study.prose.signals import limit_margin
from runner.papers.study.results import Runs
from runner.store import Run

ROWS = {"position": 3, "pose": 6}  # of the Jacobian, by the tip's task
SHOULDER = 1  # counted from 0: the joint that lifts the arm


def smallest_margin(run: Run) -> str:
    """Return the same with the joint that it is, as a cell of a table."""
    joint = int(np.argmin(run.model.limit_margins(run.joints("q")).min(axis=0)))
    return f"{number(float(limit_margin(run).min()))} (q{joint + 1})"


def lag(run: Run, rate: float | None = None) -> float:
    """Return the largest lag of the line without feedforward, in m, at a run's rate of commands or another, in Hz.

    A goal that moves at speed v runs ahead until K times the lag makes up for it; the midpoint rule meets the goal of
    the tick with the tip of half a period later: lag = v / (K (1 - h K / 2)).
    """
    controller = run.config["controller"]
    gain, period = float(controller["gain"]), float(controller["period"]) if rate is None else 1.0 / rate
    return float(peak_speed(run) / (gain * (1.0 - 0.5 * gain * period)))


def lag_at(runs: Runs, run: str) -> Callable[[float], float]:
    """Return the closed form of a run's lag as a function of the rate of the commands, in Hz."""
    return partial(lag, runs[run])


def line_length(run: Run) -> float:
    """Return the distance from A to B, in m."""
    trajectory = run.config["trajectory"]
    return float(np.linalg.norm(np.subtract(trajectory["goal"], trajectory["start"])))


def peak_speed(run: Run) -> float:
    """Return the largest speed of the desired tip on the way from A to B, in m/s."""
    return float(np.pi * line_length(run) / float(run.config["trajectory"]["duration"]))


def first_saturation(run: Run) -> tuple[int, float] | None:
    """Return the first joint at its effort limit, counted from 0, and its time, in s; None if none reaches it."""
    at_limit = np.argwhere(_at_limits(run))
    return (int(at_limit[0, 1]), float(run.t[at_limit[0, 0]])) if at_limit.size else None


def first_at_limit(run: Run) -> str:
    """Return the same as a cell of a table."""
    first = first_saturation(run)
    return "none" if first is None else f"q{first[0] + 1}, at {first[1]:.3g} s"


def at_a_limit(run: Run) -> FloatArray:
    """Return 1 at each row at which a joint is at its effort limit, otherwise and at the last row 0, shape (T,)."""
    return np.append(_at_limits(run).any(axis=1), 0.0)


def _at_limits(run: Run) -> FloatArray:
    """Return at which ticks each joint is at its effort limit, shape (T, nq)."""
    torques = np.abs(run.joints("tau"))[:-1]
    return np.asarray(torques >= run.model.effort_limits * (1.0 - 1e-9))


def nearest_to_its_limit(run: Run) -> str:
    """Return the joint that comes closest to its effort limit, or is the first at it, and its load, as a cell."""
    torques = np.abs(run.joints("tau"))[:-1].max(axis=0, initial=0.0)
    shares = torques / run.model.effort_limits
    saturated = first_saturation(run)
    joint = int(np.argmax(shares)) if saturated is None else saturated[0]
    return f"q{joint + 1}, {100.0 * shares[joint]:.3g} %"


def sag(run: Run) -> float:
    """Return |J K^-1 G|, the tip's sag by the arm's weight, its largest axis over the postures of a run, in m."""
    model = run.model
    stiffness = float(run.config["plant"]["servo"]["stiffness"])
    rows = run.joints("q")[::50]
    return max(float(np.abs(model.tip_jacobian(q)[:3] @ model.gravity_torque(q)).max()) / stiffness for q in rows)


def drifts(run: Run) -> FloatArray:
    """Return the joints' displacement over each cycle, shape (cycles,), in rad."""
    return np.asarray(np.linalg.norm(np.diff(run.joints("q")[:: cycle_ticks(run)], axis=0), axis=1))


def cycle_ticks(run: Run) -> int:
    """Return the ticks of a cycle."""
    return round(float(run.config["trajectory"]["duration"]) / float(run.config["controller"]["period"]))


def moving_mass(run: Run) -> float:
    """Return the mass of a run's arm that moves, in kg."""
    return run.model.mass
