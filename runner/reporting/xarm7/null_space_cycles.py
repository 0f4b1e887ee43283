"""Joints that do not come back where the tip does, and what a null-space task does about it."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, FloatArray, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, origin
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, failures
from runner.reporting.xarm7.studies import rate, smallest_margin
from runner.reporting.xarm7.studies_plan import CYCLE, CYCLES, NULL_SPACE_TASKS, PATHS
from runner.store import Run


def drifts(run: Run) -> FloatArray:
    """Return how far the joints are from where they were a cycle before, after each, shape (cycles,), in rad."""
    q = joint_columns(run.trace, "q")
    ticks = round(run.config["trajectory"]["duration"] / run.config["controller"]["period"])
    distance: FloatArray = np.linalg.norm(np.diff(q[::ticks], axis=0), axis=1)
    return distance


def cycles_section(runs: Mapping[str, Run]) -> Section:
    """Return the joint drift over several cycles of a line and a circle, for each null-space task."""
    ours = {name: run for name, run in runs.items() if name.startswith("cycles/")}
    rows = []
    for path in PATHS:
        for task in NULL_SPACE_TASKS:
            run = runs[f"cycles/{path}/{task}"]
            drift = drifts(run)
            first, last = (number(float(drift[k])) if drift.size else "–" for k in (0, -1))
            error = cell(run, "max_tracking_error")
            rows.append([path, task, first, last, number(float(drift.sum())), error, smallest_margin(run)])
    circle = runs["cycles/circle/none"]
    radius = float(circle.config["trajectory"]["radius"])
    gain = float(circle.config["controller"]["null_space"]["gain"])
    blocks: list[Block] = [
        Text(
            "The pseudo-inverse takes the shortest joint motion at each instant, and the shortest motions around a "
            "closed path do not add up to a closed one: the joints come back elsewhere, and each cycle goes on from "
            "there. The report's line cannot show this, as its way back is its way there: what the way out adds the "
            "way back takes away. A circle can. "
            f"Both are run {CYCLES} times in {CYCLE:g} s each, at {rate(circle)} with the tip's position led, and with "
            f"each null-space task (gain {gain:g} 1/s). The circle has a radius of {radius:g} m and steady speed."
        ),
        Table(
            "Distance of the joints from where they were a cycle before.",
            [
                "path",
                "null-space task",
                "first cycle (rad)",
                f"cycle {CYCLES} (rad)",
                "sum (rad)",
                "tip error (m)",
                "joint margin (rad)",
            ],
            rows,
            (2, 3, 4, 5, 6),
            origin(runs["cycles/circle/none"]),
        ),
        _curves(runs),
        _finding(runs),
        *failures(ours),
    ]
    return Section("Joints over several cycles", blocks)


def _curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for path in PATHS:
        series = []
        for task in NULL_SPACE_TASKS:
            drift = drifts(runs[f"cycles/{path}/{task}"])
            shown = np.where(drift > 0.0, drift, np.nan)
            series.append(Series(task, np.arange(1.0, drift.size + 1.0), shown, "points_line"))
        panels.append(Panel(path.capitalize(), "cycle", "drift of the joints (rad)", series, y_log=True))
    return Curves(
        "Drift of the joints from cycle to cycle; what is below 10⁻¹⁵ rad is rounding.",
        panels,
        2,
        origin(runs["cycles/circle/none"]),
    )


def _finding(runs: Mapping[str, Run]) -> Notice:
    last = {task: _last(runs[f"cycles/circle/{task}"]) for task in NULL_SPACE_TASKS}
    line = _last(runs["cycles/line/none"])
    free = last["none"]
    held = [task for task in NULL_SPACE_TASKS if task != "none" and _below(last[task], free)]
    return Notice(
        "finding",
        "Plain pseudo-inverse motion is not cyclic; any null-space task makes it so"
        if len(held) == len(NULL_SPACE_TASKS) - 1
        else f"Plain pseudo-inverse motion is not cyclic; cyclic with {', '.join(held) or 'no task tried'}",
        f"Around the circle the joints of the plain pseudo-inverse are {quantity(free, 'rad')} further in cycle "
        f"{CYCLES}, a tenth of a turn after {number(0.2 * np.pi / free, 2) if free else '–'} cycles at this pace; "
        f"along the line {quantity(line, 'rad', 2)}, which is integration error. With a task they settle on a closed "
        "way: in that cycle "
        + ", ".join(f"{task} {quantity(last[task], 'rad', 2)}" for task in NULL_SPACE_TASKS if task != "none")
        + ". The first cycle leads from the start to that way, and the tip does not feel it.",
    )


def _last(run: Run) -> float | None:
    drift = drifts(run)
    return float(drift[-1]) if drift.size else None


def _below(drift: float | None, free: float | None) -> bool:
    return drift is not None and free is not None and drift < 0.1 * free
