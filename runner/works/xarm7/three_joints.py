"""The line by three joints: a picture of it, and where the report's X may come from."""

from collections.abc import Mapping

import numpy as np

from runner.drawing import arm_motion
from runner.reporting.document import Picture
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.store import Run

_STILLS = (0.0, 0.25, 0.5)  # of the period: at A, half way, at B


def sketch(runs: Mapping[str, Run], run: str) -> Picture:
    """Return the arm at A, half way and at B in one picture."""
    trace, period = runs[run].trace, float(runs[run].config["trajectory"]["duration"])
    rows = [int(np.searchsorted(trace["t"].to_numpy(), share * period - 1e-9)) for share in _STILLS]
    tip, desired = columns(trace, "tip"), columns(trace, "desired")
    times = trace["t"].to_numpy()[rows].tolist()
    svg = arm_motion(model_of(runs[run]), joint_columns(trace, "q")[rows], times, tip, desired, desired[rows[-1]])
    return Picture(
        "The motion: the arm at A, half way, and at B (goal), drawn from the simulation.",
        svg,
        "The xArm7 in three postures with its tip on a horizontal line",
        0.75,
        origin(runs[run], "sketch of the motion"),
    )


def home_tip(runs: Mapping[str, Run], run: str) -> list[float]:
    """Return where the tip is at home, in m."""
    home: list[float] = model_of(runs[run]).tip_position(np.array(runs[run].config["robot"]["home"])).tolist()
    return home


def reach(run: Run) -> float:
    """Return the largest distance of a run's tip from the shoulder, in m."""
    return float(np.linalg.norm(columns(run.trace, "tip") - model_of(run).shoulder, axis=1).max())


def joint_range(runs: Mapping[str, Run], run: str, joint: str) -> str:
    """Return the least and the largest position of a joint, as a cell of a table."""
    q = runs[run].trace[joint]
    return f"{q.min():.3f} to {q.max():.3f}"
