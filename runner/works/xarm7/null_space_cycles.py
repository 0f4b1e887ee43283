"""Joints that do not come back where the tip does, and what a null-space task does about it."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.reporting.document import Block, Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import above_rounding
from runner.reporting.run_values import cell, failures, measured
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.xarm7.plan import CYCLE, CYCLES, NULL_SPACE_TASKS, PATHS
from runner.works.xarm7.studies import rate, smallest_margin


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
            first, last = (above_rounding(float(drift[k])) if drift.size else "–" for k in (0, -1))
            error = cell(run, "max_tracking_error")
            rows.append(
                [path, in_words(task), first, last, above_rounding(float(drift.sum())), error, smallest_margin(run)]
            )
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
        _concluded(runs),
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
            series.append(Series(in_words(task), np.arange(1.0, drift.size + 1.0), shown, "points_line"))
        panels.append(Panel(path.capitalize(), "cycle", "drift of the joints (rad)", series, y_log=True))
    return Curves(
        "Drift of the joints from cycle to cycle.",
        panels,
        2,
        origin(runs["cycles/circle/none"]),
    )


def _concluded(runs: Mapping[str, Run]) -> Finding:
    free = runs["cycles/circle/none"]
    held = [task for task in NULL_SPACE_TASKS if task != "none"]
    q = joint_columns(free.trace, "q")
    return conclude(
        Measured("drift in the first cycle of the circle, no task", _nth(free, 0), "rad"),
        Measured("drift in the last cycle of the circle, no task", _nth(free, -1), "rad"),
        Measured("distance of the joints from where they began, no task", float(np.linalg.norm(q[-1] - q[0])), "rad"),
        Measured("drift in the last cycle of the line, no task", _nth(runs["cycles/line/none"], -1), "rad"),
        [
            (
                in_words(task),
                Measured(f"drift in the last cycle, {task}", _nth(runs[f"cycles/circle/{task}"], -1), "rad"),
            )
            for task in held
        ],
        measured(free, "max_tracking_error", "tip error, no task"),
        [measured(runs[f"cycles/circle/{task}"], "max_tracking_error", f"tip error, {task}") for task in held],
    )


def conclude(
    first: Measured,
    free: Measured,
    away: Measured,
    line: Measured,
    held: Sequence[tuple[str, Measured]],
    free_error: Measured,
    errors: Sequence[Measured],
) -> Finding:
    """Return whether the joints come back where the tip does.

    Args:
        first: How far the joints of the plain pseudo-inverse are on after the first cycle of the circle.
        free: The same after the last cycle, against the one before.
        away: How far they are then from where they began.
        line: As `free`, along the line.
        held: As `free`, by null-space task.
        free_error: Tip error of the plain pseudo-inverse around the circle.
        errors: The same with each null-space task.
    """
    settled = ", ".join(f"{drift} ({task})" for task, drift in held)
    return finding(
        "Plain pseudo-inverse motion is not cyclic; each null-space task tried leads to a closed way",
        f"Around the circle the joints of the plain pseudo-inverse are {first} further after the first cycle, {free} "
        f"in cycle {CYCLES}, and {away} in all: always the same way. Along the line it is {line}. With a task they "
        f"settle towards a closed way, at less than a tenth of the drift without: in cycle {CYCLES} {settled}. What "
        "the first cycles take to lead there the tip does not feel.",
        free.near(first, 0.1),
        away.near(CYCLES * free, 0.1),
        line < 1e-3 * free,
        *(drift < 0.1 * free for _, drift in held),
        *(error.near(free_error, 0.1) for error in errors),
    )


def _nth(run: Run, cycle: int) -> float | None:
    drift = drifts(run)
    return float(drift[cycle]) if drift.size else None
