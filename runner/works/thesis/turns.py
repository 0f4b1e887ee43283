"""One arm at a time against both at once."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, clock, failures, measured
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.thesis.plan import SCHEDULES, TURN_DURATIONS
from runner.works.thesis.studies import settled

_SCHEDULE = {"both": "both at any time", "turns": "in turns"}


def turns_section(runs: Mapping[str, Run]) -> Section:
    """Return goal and tracking with both arms moving at any time, and with one arm moving at a time."""
    ours = {name: run for name, run in runs.items() if name.startswith("turns/")}
    rows = [
        [
            in_words(preset),
            _SCHEDULE[schedule],
            settled(goal),
            cell(goal, "steady_state_error"),
            *_tracking_cells(track),
        ]
        for preset in PRESETS
        for schedule in SCHEDULES
        for goal, track in [[runs[f"turns/{preset}/{motion}/{schedule}"] for motion in ("goal", "quintic")]]
    ]
    slower = [
        [f"{t_f:g}", *(cell(runs[f"turns/{t_f}/{schedule}"], "max_tracking_error") for schedule in SCHEDULES)]
        for t_f in TURN_DURATIONS
    ]
    first = runs["turns/sound/quintic/turns"]
    period = float(first.config["controller"]["period"]["macro"])
    blocks: list[Block] = [
        Text(
            "Method 3 as the thesis words it: Macro and Mini take turns to move. Taken physically, while the target "
            f"is within the Mini's reach each arm moves for a Macro period of {number(1e3 * period)} ms and holds "
            "its posture for the next, and an arm that holds brakes. One-way coupling, no noise. Both arms move at "
            "any time in all other chapters."
        ),
        Table(
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
            origin(first),
        ),
        _curves(runs),
        Table(
            "Largest tracking error with the full equations when more time is given.",
            ["$t_f$ (s)", *(f"{_SCHEDULE[schedule]} (m)" for schedule in SCHEDULES)],
            slower,
            (0, 1, 2),
            origin(runs[f"turns/{TURN_DURATIONS[0]}/turns"]),
        ),
        _finding(runs),
        *failures(ours),
    ]
    return Section("Taking turns", blocks)


def _tracking_cells(run: Run) -> list[str]:
    return [cell(run, metric) for metric in ("max_tracking_error", "macro_max_tracking_error", "steady_state_error")]


def _curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for title, signal in (("Tip", "error"), ("Macro's end point", "macro_error")):
        series = []
        for schedule in SCHEDULES:
            run = runs[f"turns/sound/quintic/{schedule}"]
            error = np.linalg.norm(columns(run.trace, signal), axis=1)
            series.append(Series(_SCHEDULE[schedule], clock(run), np.where(error > 0.0, error, np.nan)))
        panels.append(Panel(title, "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 1.0)))
    return Curves("Tracking with the full equations.", panels, 2, origin(runs["turns/sound/quintic/turns"]))


def _finding(runs: Mapping[str, Run]) -> Finding:
    both, turns = (
        _error(runs, f"turns/sound/quintic/{schedule}", f"{_SCHEDULE[schedule]} (full equations)")
        for schedule in SCHEDULES
    )
    reported = [
        _error(runs, f"turns/as_reported/quintic/{schedule}", f"{_SCHEDULE[schedule]} (as reported)")
        for schedule in SCHEDULES
    ]
    longest = TURN_DURATIONS[-1]
    slow_both, slow_turns = (
        _error(runs, f"turns/{longest}/{schedule}", f"{_SCHEDULE[schedule]}, {longest:g} s") for schedule in SCHEDULES
    )
    goal_both, goal_turns = (
        measured(runs[f"turns/sound/goal/{schedule}"], "settling_time", f"settling time, {_SCHEDULE[schedule]}")
        for schedule in SCHEDULES
    )
    duration = quantity(float(runs["turns/sound/quintic/turns"].config["trajectory"]["duration"]), "s")
    return finding(
        f"Taking turns destroys tracking on a {duration} trajectory",
        f"With turns the tip errs by {turns}, {turns / both} times as much as when both arms move at any time (full "
        f"equations), and under the preset as reported {reported[1] / reported[0]} times as much. The Macro moves "
        f"half of the time and starts each turn from rest. Given {longest:g} s tracking does not recover: "
        f"{slow_turns} against {slow_both}. The goal move takes hardly longer, {goal_turns} against {goal_both}: the "
        "Mini's turns begin only once the goal is within its reach.",
        turns > 100.0 * both,
        turns > 0.02,
        reported[1] > 2.0 * reported[0],
        slow_turns > 100.0 * slow_both,
        slow_turns > 0.2 * turns,
        goal_turns.near(goal_both, 0.15),
    )


def _error(runs: Mapping[str, Run], name: str, words: str) -> Measured:
    return measured(runs[name], "max_tracking_error", f"tip error, {words}")
