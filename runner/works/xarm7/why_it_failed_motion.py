"""What each error of the xArm7 report's second part does to the motion."""

import math
from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, joint_columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.run_values import cell, clock, measured, median
from runner.store import Run
from runner.works.xarm7.plan import ERRORS, GAIN, TASKS
from runner.works.xarm7.studies import error_norm, smallest_margin

_SHOWN = ("columns and angles", "columns alone", "angles alone", "none")
_METRICS = ("max_tracking_error", "cross_track_error", "peak_joint_speed")


def motion_section(runs: Mapping[str, Run]) -> Section:
    """Return the line run with each error, with and without the tip's error fed back, and the working law beside."""
    first = runs["printed/position/as printed"]
    period = float(first.config["controller"]["period"])
    rows = [
        [task, case, feedback, *_outcome(runs[name])] for task in TASKS for case, feedback, name in _cases(runs, task)
    ]
    blocks: list[Block] = [
        Text(
            f"The line with the report's law run as printed, at {1.0 / period:g} Hz on joints that go where they are "
            "told, and with each error alone, the others put right. The report feeds no error of the tip back; where "
            f"the table says so, it is fed back with {GAIN:g} 1/s. The last row of each task is the corrected law. A "
            "margin below zero is a joint beyond its limit, which the printed law does not look at."
        ),
        Table(
            "What each error does to the line, position task (3 rows) and pose task (6 rows).",
            [
                "task",
                "errors left in",
                "fed back",
                "outcome",
                "largest axis error (m)",
                "off the line (m)",
                "joint speed (rad/s)",
                "joint margin (rad)",
            ],
            rows,
            (4, 5, 6, 7),
            origin(first),
        ),
        _paths(runs),
        _errors(runs),
        _concluded(runs),
    ]
    return Section("What each error does to the motion", blocks)


def _cases(runs: Mapping[str, Run], task: str) -> list[tuple[str, str, str]]:
    """Return the cases of a task: errors, feedback, name of the run."""
    cases = []
    for case in ERRORS:
        name = f"printed/{task}/{case}"
        cases.append((case, "no", name))
        if f"{name}/fed back" in runs:
            cases.append((case, "yes", f"{name}/fed back"))
    return [*cases, ("corrected law", "yes", f"printed/{task}/working")]


def _outcome(run: Run) -> list[str]:
    metrics = [cell(run, metric) for metric in _METRICS]
    if run.failure is None:
        return ["runs", *metrics, smallest_margin(run)]
    return [f"ends at {run.failure['time']:.4g} s: {str(run.failure['reason']).lower()}", *["–"] * len(metrics), "–"]


def _paths(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for task in TASKS:
        for title, axis in ((f"{task.capitalize()} task, from above", "x"), (f"{task.capitalize()} task, side", "z")):
            index = "xyz".index(axis)
            series = []
            for number_, (label, name) in enumerate(_shown(task)):
                tip = columns(runs[name].trace, "tip")
                series.append(Series(label, tip[:, 1], tip[:, index], color=number_))
            panels.append(Panel(title, "y (m)", f"{axis} (m)", series))
    return Curves(
        "Path of the tip over one period, nothing fed back, right pseudo-inverse; the corrected law beside it.",
        panels,
        2,
        origin(runs["printed/position/columns and angles"]),
    )


def _shown(task: str) -> list[tuple[str, str]]:
    return [*((case, f"printed/{task}/{case}") for case in _SHOWN), ("corrected law", f"printed/{task}/working")]


def _errors(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for task in TASKS:
        series = []
        for color, (label, name) in enumerate(_shown(task)):
            series.append(Series(label, clock(runs[name]), error_norm(runs[name]), color=color))
            fed_back = runs.get(f"{name}/fed back")
            if fed_back is not None:
                series.append(
                    Series(f"{label}, fed back", clock(fed_back), error_norm(fed_back), "dotted", color=color)
                )
        panels.append(
            Panel(f"{task.capitalize()} task", "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 3.0))
        )
    return Curves(
        "Tip error with each error of the report, right pseudo-inverse.",
        panels,
        2,
        origin(runs["printed/position/columns and angles/fed back"]),
    )


def _concluded(runs: Mapping[str, Run]) -> Finding:
    def error(case: str) -> Measured:
        return measured(runs[f"printed/position/{case}"], "max_tracking_error", f"largest axis error, {case}")

    inverses = [run for task in TASKS for run in _inverses(runs, task)]
    trajectory = inverses[0].config["trajectory"]
    length = math.dist(trajectory["start"], trajectory["goal"])
    errors = [median(run, "max_tracking_error") for run in inverses]
    following = sum(each is not None and each < 0.1 * length for each in errors)
    alone = runs["printed/position/columns alone"]
    speeds = joint_columns(alone.trace, "dq")
    return conclude(
        len(inverses),
        Measured("runs with the printed inverse that follow the line", float(following)),
        Measured("runs with it that end early", float(sum(run.failure is not None for run in inverses))),
        Measured("length of the line", length, "m"),
        error("columns alone"),
        error("columns alone/fed back"),
        measured(alone, "cross_track_error", "distance from the line, columns alone"),
        Measured(
            "difference of the first two joints' speeds", float(np.abs(speeds[:, 0] - speeds[:, 1]).max()), "rad/s"
        ),
        Measured("largest speed of the first joint", float(np.abs(speeds[:, 0]).max()), "rad/s"),
        measured(runs["printed/position/columns alone/fed back"], "peak_joint_speed", "joint speed, fed back"),
        error("angles alone"),
        error("angles alone/fed back"),
        error("none"),
        error("none/fed back"),
        error("working"),
    )


def conclude(
    count: int,
    following: Measured,
    ended: Measured,
    length: Measured,
    columns_alone: Measured,
    columns_fed: Measured,
    off: Measured,
    unequal: Measured,
    first_speed: Measured,
    speed: Measured,
    angles_alone: Measured,
    angles_fed: Measured,
    drift: Measured,
    drift_fed: Measured,
    ours: Measured,
) -> Finding:
    """Return what each error costs, position task.

    Args:
        count: Runs with the printed inverse, of both tasks.
        following: How many of them run the period with an error below a tenth of the line.
        ended: How many end early.
        length: Length of the line.
        columns_alone: Largest axis error where the columns are as printed.
        columns_fed: The same with the tip's error fed back.
        off: Distance from the line where the columns are as printed.
        unequal: Largest difference of the first two joints' speeds there.
        first_speed: Largest speed of the first joint there.
        speed: Largest joint speed there with the tip's error fed back.
        angles_alone: Largest axis error where the angles are as printed.
        angles_fed: The same with the tip's error fed back.
        drift: Largest axis error with every error put right.
        drift_fed: The same with the tip's error fed back.
        ours: Largest axis error of the working law.
    """
    return finding(
        "Three errors, and the right pseudo-inverse cures one of them",
        f"Of {count} runs with the printed inverse {following} follow the line; {ended} end early, as its matrix is "
        "found to be singular. With the right pseudo-inverse the arm moves, but not along the line: each joint does "
        "what the one before it should, and the first two share what is the first one's. The columns alone cost "
        f"{columns_alone} of a line of {length}; feeding the tip's error back does not mend it: {columns_fed}, with "
        f"joints at up to {speed}. The angles alone cost {angles_alone}; feedback brings that down to {angles_fed}. "
        f"With every error put right the drift of open-loop integration is left, {drift}; feedback brings it down to "
        f"{drift_fed}, and the corrected law, which integrates by the midpoint rule, has {ours}.",
        following <= 0.0,
        columns_alone > 0.5 * length,
        columns_fed > 0.5 * columns_alone,
        off > 0.1 * length,
        unequal < 1e-6 * first_speed,
        angles_alone > 3.0 * drift,
        angles_fed < 0.2 * angles_alone,
        drift < 0.01 * length,
        drift_fed < 0.2 * drift,
        ours < 0.2 * drift_fed,
    )


def _inverses(runs: Mapping[str, Run], task: str) -> list[Run]:
    return [runs[f"printed/{task}/{case}"] for case, errors in ERRORS.items() if "inverse" in errors]
