"""What each error of the xArm7 report's second part does to the motion."""

import math
from collections.abc import Mapping

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, clock, median
from runner.reporting.xarm7.studies import error_norm, smallest_margin
from runner.reporting.xarm7.studies_plan import ERRORS, GAIN, TASKS
from runner.store import Run

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
            "told, and with each error alone, the others put right. The report feeds no error of the tip back; "
            f"where it says so, we feed it back with {GAIN:g} 1/s. The last row of each task is our law. A margin "
            "below zero is a joint beyond its limit, which the printed law does not look at."
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
        _finding(runs),
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
    return [*cases, ("our law", "yes", f"printed/{task}/working")]


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
        "Path of the tip over one period, nothing fed back, right pseudo-inverse; our law beside.",
        panels,
        2,
        origin(runs["printed/position/columns and angles"]),
    )


def _shown(task: str) -> list[tuple[str, str]]:
    return [*((case, f"printed/{task}/{case}") for case in _SHOWN), ("our law", f"printed/{task}/working")]


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


def _finding(runs: Mapping[str, Run]) -> Notice:
    def error(name: str) -> float | None:
        return median(runs[f"printed/{name}"], "max_tracking_error")

    def text(name: str) -> str:
        return quantity(error(name), "m")

    def fed_back(name: str) -> str:
        without, with_it = error(name), error(f"{name}/fed back")
        helps = without is not None and with_it is not None and with_it < 0.5 * without
        return f"{'brings it down to' if helps else 'does not mend it:'} {text(f'{name}/fed back')}"

    inverses = [run for task in TASKS for run in _inverses(runs, task)]
    ends = [run.failure["time"] for run in inverses if run.failure is not None]
    trajectory = inverses[0].config["trajectory"]
    length = math.dist(trajectory["start"], trajectory["goal"])
    last = f", the last at {number(float(max(ends)), 2)} s" if ends else ""
    return Notice(
        "finding",
        "Three errors, and the right pseudo-inverse cures one of them",
        f"Of {len(inverses)} runs with the printed inverse {len(ends)} end before the period is over{last}. With the "
        "right pseudo-inverse the arm moves, but not along the line: each joint does what the one before it should, "
        "and joints 1 and 2 share what is joint 1's. The columns alone cost "
        f"{text('position/columns alone')} of a line of {quantity(length, 'm')}; feeding the tip's error back "
        f"{fed_back('position/columns alone')}, with joints at up to "
        f"{quantity(median(runs['printed/position/columns alone/fed back'], 'peak_joint_speed'), 'rad/s')}. The "
        f"angles alone cost {text('position/angles alone')}; feedback {fed_back('position/angles alone')}. With "
        f"every error put right the drift of open-loop integration is left, {text('position/none')}; feedback "
        f"{fed_back('position/none')}, and our law, which integrates by the midpoint rule, has "
        f"{text('position/working')}.",
    )


def _inverses(runs: Mapping[str, Run], task: str) -> list[Run]:
    return [runs[f"printed/{task}/{case}"] for case, errors in ERRORS.items() if "inverse" in errors]
