"""Manipulability along the line, and what the null-space task makes of it."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.null_space import manipulability
from runner.reporting.document import Block, Curves, FloatArray, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.quantities import number
from runner.reporting.run_values import cell, clock, failures
from runner.reporting.xarm7.studies import smallest_margin
from runner.reporting.xarm7.studies_plan import CLIMB_CYCLE, CLIMB_CYCLES, SOUGHT, TASKS
from runner.reporting.xarm7.why_it_failed import ROWS
from runner.store import Run

_LABELS = {"posture": "home's posture sought", "manipulability": "manipulability sought"}


def measures(run: Run) -> FloatArray:
    """Return manipulability w and smallest singular value of the tip's task at each tick, shape (T, 2)."""
    model, rows = model_of(run), ROWS[run.config["controller"]["task"]]
    values = np.empty((len(run.trace), 2))
    for row, q in zip(values, joint_columns(run.trace, "q"), strict=True):
        J = model.tip_jacobian(q)[:rows]
        row[:] = manipulability(J), np.linalg.svd(J, compute_uv=False)[-1]
    return values


def manipulability_section(runs: Mapping[str, Run]) -> Section:
    """Return manipulability along the line with the posture task and with the manipulability task."""
    ours = {name: run for name, run in runs.items() if name.startswith("climb/")}
    dexterity = {name: measures(run) for name, run in ours.items()}
    rows = []
    for task in TASKS:
        for sought, label in _LABELS.items():
            run = ours[f"climb/{task}/{sought}"]
            last = dexterity[f"climb/{task}/{sought}"][_last_cycle(run)]
            w = f"{number(float(last[:, 0].min()))} to {number(float(last[:, 0].max()))}"
            error = cell(run, "max_tracking_error")
            rows.append([task, label, w, number(float(last[:, 1].min())), error, smallest_margin(run)])
    gain = float(runs["climb/pose/manipulability"].config["controller"]["null_space"]["gain"])
    blocks: list[Block] = [
        Text(
            "Yoshikawa's manipulability $w = sqrt(det J J^T)$ is zero at a singular posture and large where every tip "
            f"velocity costs little joint motion. The line is run {CLIMB_CYCLES} times in {CLIMB_CYCLE:g} s each, "
            f"with home's posture as the null-space task, and with the gradient of $ln w$ in its place, gain {gain:g}."
        ),
        Table(
            "The last cycle along the line.",
            [
                "task of the tip",
                "null space",
                "$w$ (m³)",
                "smallest singular value",
                "tip error (m)",
                "joint margin (rad)",
            ],
            rows,
            (2, 3, 4, 5),
            origin(runs["climb/pose/manipulability"]),
        ),
        _curves(ours, dexterity),
        _finding(ours, dexterity),
        *failures(ours),
    ]
    return Section("Manipulability along the line", blocks)


def _last_cycle(run: Run) -> slice:
    ticks = round(run.config["trajectory"]["duration"] / run.config["controller"]["period"])
    return slice(max(len(run.trace) - ticks - 1, 0), None)


def _curves(ours: Mapping[str, Run], dexterity: Mapping[str, FloatArray]) -> Curves:
    panels = []
    for task in TASKS:
        over_time, over_line = [], []
        for color, (sought, label) in enumerate(_LABELS.items()):
            name = f"climb/{task}/{sought}"
            run, w = ours[name], dexterity[name][:, 0]
            last = _last_cycle(run)
            over_time.append(Series(label, clock(run), w, color=color))
            over_line.append(Series(label, columns(run.trace, "tip")[last, 1], w[last], color=color))
        title, w_label = f"{task.capitalize()} task", "w (m³)"
        panels.append(Panel(title, "time (s)", w_label, over_time))
        panels.append(Panel(f"{title}, last cycle", "y of the tip (m)", w_label, over_line))
    return Curves(
        "Manipulability over time, and along the line in the last cycle.",
        panels,
        2,
        origin(ours["climb/pose/manipulability"]),
    )


def _finding(ours: Mapping[str, Run], dexterity: Mapping[str, FloatArray]) -> Notice:
    gains = {}
    for task in TASKS:
        least = {sought: _least(ours, dexterity, task, sought) for sought in SOUGHT}
        gains[task] = 100.0 * (least["manipulability"] / least["posture"] - 1.0)
    run = ours["climb/pose/manipulability"]
    q = joint_columns(run.trace, "q")
    moved = int(np.argmax(np.abs(q[-1] - q[0])))
    return Notice(
        "finding",
        f"Seeking it lifts the least w by {gains['position']:.2g} % (position) and {gains['pose']:.2g} % (pose)",
        "For the position alone the round posture is near the best there is. For the pose the arm begins next to a "
        "vertical plane, where by symmetry a sideways motion of the elbow changes $w$ to second order only: a "
        "stationary point, and not the best. It takes the line's own asymmetry, and a while, until the elbow falls "
        f"out of the plane (q{moved + 1} goes by {number(float(abs(q[-1] - q[0])[moved]))} rad); the tip stays on its "
        "line.",
    )


def _least(ours: Mapping[str, Run], dexterity: Mapping[str, FloatArray], task: str, sought: str) -> float:
    name = f"climb/{task}/{sought}"
    return float(dexterity[name][_last_cycle(ours[name]), 0].min())
