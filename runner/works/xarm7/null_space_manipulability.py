"""Manipulability along the line, and what the null-space task makes of it."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.null_space import manipulability
from runner.reporting.document import Block, Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import cell, clock, failures, measured
from runner.store import Run
from runner.works.xarm7.plan import CLIMB_CYCLE, CLIMB_CYCLES, TASKS
from runner.works.xarm7.studies import smallest_margin
from runner.works.xarm7.why_it_failed import ROWS

_ASIDE = [2, 4]  # the joints that lead the elbow out of the arm's vertical plane
_ELBOW = 4  # the one of them that shows it
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
        _concluded(ours, dexterity),
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


def _concluded(ours: Mapping[str, Run], dexterity: Mapping[str, FloatArray]) -> Finding:
    run = ours["climb/pose/manipulability"]
    q = joint_columns(run.trace, "q")
    elbow = np.abs(q[:, _ELBOW] - q[0, _ELBOW])
    away = elbow > 0.5 * elbow[-1]
    least = {
        f"{task}/{sought}": Measured(f"least w, {task}, {label}", _least(ours, dexterity, task, sought), "m³")
        for task in TASKS
        for sought, label in _LABELS.items()
    }
    return conclude(
        least["position/posture"],
        least["position/manipulability"],
        least["pose/posture"],
        least["pose/manipulability"],
        Measured(
            f"larger of {' and '.join(f'q{joint + 1}' for joint in _ASIDE)} at the start",
            float(np.abs(q[0, _ASIDE]).max()),
            "rad",
        ),
        Measured(f"way of q{_ELBOW + 1}", float(elbow[-1]), "rad"),
        Measured(f"time until q{_ELBOW + 1} has gone half its way", float(clock(run)[int(np.argmax(away))]), "s"),
        measured(run, "max_tracking_error", "tip error, pose, manipulability sought"),
    )


def conclude(
    position: Measured,
    position_sought: Measured,
    pose: Measured,
    pose_sought: Measured,
    aside: Measured,
    fallen: Measured,
    half: Measured,
    error: Measured,
) -> Finding:
    """Return what it gains to seek manipulability.

    Args:
        position: Least manipulability in the last cycle with home's posture sought, position task.
        position_sought: The same with manipulability sought.
        pose: The same with home's posture sought, pose task.
        pose_sought: The same with manipulability sought.
        aside: How far the joints that lead the elbow out of the arm's vertical plane are from zero at the start.
        fallen: How far the elbow has turned out of the plane in the end.
        half: When it has gone half of that.
        error: Tip error of the pose task with manipulability sought.
    """
    gains = [
        Measured(f"gain, {task}", None if share.value is None else 100.0 * (share.value - 1.0), "%")
        for task, share in (("position", position_sought / position), ("pose", pose_sought / pose))
    ]
    return finding(
        f"Climbing the gradient raises the smallest w by {gains[0]} (position) and {gains[1]} (pose)",
        "For the position alone it changes little where home's posture is sought. For the pose the arm begins next to "
        f"a vertical plane (the joints that lead the elbow aside are within {aside} of it), where by symmetry a "
        "sideways motion of the elbow changes $w$ to second order only: a stationary point, and not the best. It takes "
        f"more than a cycle, {half}, until the elbow has gone half its way out of the plane (q{_ELBOW + 1} goes by "
        f"{fallen}); the tip stays on its line, within {error}.",
        (position_sought / position).near(1.0, 0.03),
        pose_sought > 1.05 * pose,
        aside < 0.05,
        fallen > 0.5,
        half > CLIMB_CYCLE,
        error < 1e-5,
    )


def _least(ours: Mapping[str, Run], dexterity: Mapping[str, FloatArray], task: str, sought: str) -> float:
    name = f"climb/{task}/{sought}"
    return float(dexterity[name][_last_cycle(ours[name]), 0].min())
