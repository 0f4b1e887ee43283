"""Line motion of the xArm7 with three joints: a picture, and quantities for the origin of the report's X."""

from collections.abc import Callable

import numpy as np

from runner.base.arrays import FloatArray
from runner.papers.study.results import Runs
from runner.papers.study.run_values import trace_of
from runner.reporting.charts.arm import arm_motion
from runner.reporting.document import Picture
from runner.reporting.figures import origin
from runner.store import Run

_STILLS = (0.0, 0.25, 0.5)  # of the period: at A, half way, at B


def sketch(runs: Runs, run: str) -> Picture:
    """Return the arm at A, half way and at B in one picture."""
    shown, period = runs[run], float(runs[run].config["trajectory"]["duration"])
    rows = [int(np.searchsorted(shown.t, share * period - 1e-9)) for share in _STILLS]
    tip, desired = shown.vector("tip"), shown.vector("desired")
    svg = arm_motion(shown.model, shown.joints()[rows], shown.t[rows].tolist(), tip, desired, desired[rows[-1]])
    return Picture(
        "The arm moves its tip from A, over half the way, to B (goal) in a level line; drawn from the simulation.",
        svg,
        "The xArm7 in three postures, with its tip at the beginning, in the middle and at the end of a level line",
        0.42,
        origin(runs[run], "sketch of the motion"),
    )


def every(seconds: float, signal: str) -> Callable[[Run], FloatArray]:
    """Return a signal at instants so far apart, to be drawn as points on a line that would hide its curve."""
    return lambda run: trace_of(signal, run)[:: round(seconds / float(run.config["controller"]["period"]))]


def home_tip(runs: Runs, run: str) -> list[float]:
    """Return the tip's position at home, in m."""
    home: list[float] = runs[run].model.tip_position(np.array(runs[run].config["robot"]["home"])).tolist()
    return home


def reach(run: Run) -> float:
    """Return the largest distance of a run's tip from the shoulder, in m."""
    return float(np.linalg.norm(run.vector("tip") - run.model.shoulder, axis=1).max())
