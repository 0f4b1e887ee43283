"""What the thesis' chapters in Markdown call: figures, tables and sections from its runs."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table
from runner.reporting.figures import columns, origin
from runner.reporting.job import PRESETS
from runner.reporting.run_values import cell, clock
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.thesis import arm
from runner.works.thesis.plan import SCHEDULES, TURN_DURATIONS
from runner.works.thesis.studies import settled

_GOAL = ("settling_time", "steady_state_error", "overshoot", "peak_torque", "saturation_fraction")
_TRACKING = (
    "max_tracking_error",
    "max_tracking_error_x",
    "max_tracking_error_y",
    "max_tracking_error_z",
    "rms_tracking_error",
    "steady_state_error",
    "peak_torque",
    "saturation_fraction_q1",
)
_SCHEDULE = {"both": "both at any time", "turns": "in turns"}


def kinematics(runs: Mapping[str, Run], run: str, figure: str, table: str, first: int, tip: str) -> Section:
    """Return frame assignment and D-H table of a run's arm; see arm.kinematics."""
    return arm.kinematics(runs[run], figure, table, first, tip)


def dynamics(runs: Mapping[str, Run], run: str, length: float, mass: float) -> Section:
    """Return how far the thesis' printed matrices and the model of a run's arm agree; see arm.dynamics."""
    return arm.dynamics(runs[run], length, mass)


def control_law(runs: Mapping[str, Run], run: str, goal: bool, figure: str) -> list[Block]:
    """Return equations and block diagram of the law that a run executed."""
    return arm.control_law(runs[run], goal, figure)


def goal_position(runs: Mapping[str, Run], number: str, what: str, until: float | None = None) -> list[Block]:
    """Return a figure of a goal move under both presets, with its numbers; see arm.reproduced."""
    return arm.reproduced(runs, number, what, _GOAL, until)


def tracking(runs: Mapping[str, Run], number: str, what: str) -> list[Block]:
    """Return a figure of a tracked trajectory under both presets, with its numbers; see arm.reproduced."""
    return arm.reproduced(runs, number, what, _TRACKING)


def turns_table(runs: Mapping[str, Run]) -> Table:
    """Return goal and tracking with both arms moving at any time, and with one arm moving at a time."""
    tracked = ("max_tracking_error", "macro_max_tracking_error", "steady_state_error")
    rows = [
        [
            in_words(preset),
            _SCHEDULE[schedule],
            settled(goal),
            cell(goal, "steady_state_error"),
            *(cell(track, metric) for metric in tracked),
        ]
        for preset in PRESETS
        for schedule in SCHEDULES
        for goal, track in [[runs[f"turns/{preset}/{motion}/{schedule}"] for motion in ("goal", "quintic")]]
    ]
    return Table(
        "Both arms at any time against turns.",
        [
            "preset",
            "schedule",
            "goal: settles (s)",
            "steady error (m)",
            "tracking: largest error (m)",
            "Macro's own (m)",
            "steady error (m)",
        ],
        rows,
        (2, 3, 4, 5, 6),
        origin(runs["turns/sound/quintic/turns"]),
    )


def slower_turns(runs: Mapping[str, Run]) -> Table:
    """Return the largest tracking error when more time is given."""
    rows = [
        [f"{t_f:g}", *(cell(runs[f"turns/{t_f}/{schedule}"], "max_tracking_error") for schedule in SCHEDULES)]
        for t_f in TURN_DURATIONS
    ]
    return Table(
        "Largest tracking error with the full equations when more time is given.",
        ["$t_f$ (s)", *(f"{_SCHEDULE[schedule]} (m)" for schedule in SCHEDULES)],
        rows,
        (0, 1, 2),
        origin(runs[f"turns/{TURN_DURATIONS[0]}/turns"]),
    )


def turns_curves(runs: Mapping[str, Run]) -> Curves:
    """Return the errors of the tip and of the Macro's end point over time."""
    panels = []
    for title, signal in (("Tip", "error"), ("Macro's end point", "macro_error")):
        series = []
        for schedule in SCHEDULES:
            run = runs[f"turns/sound/quintic/{schedule}"]
            error = np.linalg.norm(columns(run.trace, signal), axis=1)
            series.append(Series(_SCHEDULE[schedule], clock(run), np.where(error > 0.0, error, np.nan)))
        panels.append(Panel(title, "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 1.0)))
    return Curves("Tracking with the full equations.", panels, 2, origin(runs["turns/sound/quintic/turns"]))
