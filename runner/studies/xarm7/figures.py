"""Quantities of a run that are not metrics: joint margins, lag, saturation, sag and drift."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pinocchio as pin

from runner.base.quantities import number
from runner.store import Run
from runner.study.prose.signals import limit_margin
from runner.study.results import Runs
from runner.study.run_values import values

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


def power_of_the_rate(slow: Run, fast: Run) -> float | None:
    """Return by which power of the commands' rate the largest axis error falls from one run to another."""
    errors = values((slow, fast), "max_axis_error")
    periods = [run.config["controller"]["period"] for run in (slow, fast)]
    return float(np.log(errors[0] / errors[1]) / np.log(periods[0] / periods[1])) if errors.all() else None


def line_length(run: Run) -> float:
    """Return the distance from A to B, in m."""
    trajectory = run.config["trajectory"]
    return float(np.linalg.norm(np.subtract(trajectory["goal"], trajectory["start"])))


def peak_speed(run: Run) -> float:
    """Return the largest speed of the desired tip on the way from A to B, in m/s."""
    return float(np.pi * line_length(run) / float(run.config["trajectory"]["duration"]))


def first_saturation(run: Run) -> tuple[int, float] | None:
    """Return the first joint at its effort limit, counted from 0, and its time, in s; None if none reaches it."""
    at_limit = _at_limits(run)
    if not at_limit.any():
        return None
    row, joint = np.argwhere(at_limit)[0]
    return int(joint), float(run.t[row])


def first_at_limit(run: Run) -> str:
    """Return the same as a cell of a table."""
    first = first_saturation(run)
    return "none" if first is None else f"q{first[0] + 1}, at {first[1]:.3g} s"


def ticks_at_a_limit(run: Run) -> str:
    """Return the ticks at which a joint is at its effort limit, in per cent, as a cell of a table."""
    return f"{100.0 * float(run.metrics['saturation_fraction'].median or 0.0):.3g} %"


def clipped_ticks(run: Run) -> float:
    """Return the number of ticks at which a joint is at its effort limit."""
    return float(_at_limits(run).any(axis=1).sum())


def last_clipped(run: Run) -> float | None:
    """Return the last time at which a joint is at its effort limit, in s; None if there is none."""
    times = run.t[:-1][_at_limits(run).any(axis=1)]
    return float(times[-1]) if times.size else None


def _at_limits(run: Run) -> np.ndarray:
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


def flange_turn(run: Run) -> float:
    """Return the largest angle between the flange's orientation and the one it starts with, in rad."""
    model, q = run.model, run.joints("q")
    first = model.tip_pose(q[0])[:3, :3]
    return max(float(np.linalg.norm(pin.log3(first.T @ model.tip_pose(row)[:3, :3]))) for row in q[::10])


def second_drift(run: Run) -> float:
    """Return the largest joint displacement from the end of the first period to the end, in rad."""
    q = run.joints("q")
    after = int(np.searchsorted(run.t, float(run.config["trajectory"]["duration"]) - 1e-9))
    return float(np.abs(q[-1] - q[after]).max())


def moving_mass(run: Run) -> float:
    """Return the mass of a run's arm that moves, in kg."""
    return run.model.mass
