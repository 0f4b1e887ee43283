"""One arm at a time against both at once."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.job import PRESETS
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, clock, failures, median
from runner.reporting.thesis.combined_plan import SCHEDULES, TURN_DURATIONS
from runner.reporting.thesis.studies import ratio, settled
from runner.store import Run


def turns_section(runs: Mapping[str, Run]) -> Section:
    """Return goal and tracking with both arms moving at any time, and with one arm moving at a time."""
    ours = {name: run for name, run in runs.items() if name.startswith("turns/")}
    rows = [
        [preset, schedule, settled(goal), cell(goal, "steady_state_error"), *_tracking_cells(track)]
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
            "its posture for the next, and an arm that holds brakes. One-way coupling, no noise."
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
            "Preset sound: largest tracking error (m) when more time is given.",
            ["$t_f$ (s)", *SCHEDULES],
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
            series.append(Series(schedule, clock(run), np.where(error > 0.0, error, np.nan)))
        panels.append(Panel(title, "time (s)", "error norm (m)", series, y_log=True, y_range=(1e-8, 1.0)))
    return Curves("Tracking with preset sound.", panels, 2, origin(runs["turns/sound/quintic/turns"]))


def _finding(runs: Mapping[str, Run]) -> Notice:
    errors = {
        preset: [median(runs[f"turns/{preset}/quintic/{schedule}"], "max_tracking_error") for schedule in SCHEDULES]
        for preset in PRESETS
    }
    both, turns = errors["sound"]
    damaged = both is not None and (turns is None or turns > 10.0 * both)
    last = [median(runs[f"turns/{TURN_DURATIONS[-1]}/{schedule}"], "max_tracking_error") for schedule in SCHEDULES]
    recovers = None not in last and turns is not None and last[1] is not None and last[1] < 0.1 * turns
    goal = [median(runs[f"turns/sound/goal/{schedule}"], "settling_time") for schedule in SCHEDULES]
    return Notice(
        "finding",
        f"Taking turns destroys tracking on a {_duration(runs)} trajectory"
        if damaged
        else "Taking turns does little harm",
        f"Largest tip error with turns: {ratio(errors['sound'][1], errors['sound'][0])} times that of both (sound), "
        f"{ratio(errors['as_reported'][1], errors['as_reported'][0])} times (as_reported). The Macro moves half of "
        f"the time and starts each turn from rest. Given {TURN_DURATIONS[-1]:g} s it "
        f"{'recovers' if recovers else 'does not recover'}: {quantity(last[1], 'm')} against "
        f"{quantity(last[0], 'm')}. The goal move {_minds(goal)} ({number(goal[1])} against {number(goal[0])} s): "
        "the Mini's turns begin only once the goal is within its reach. Both arms move at any time in all other "
        "chapters.",
    )


def _minds(times: list[float | None]) -> str:
    both, turns = times
    if both is None or turns is None:
        return "does not settle in one of the two"
    return "hardly minds" if abs(turns / both - 1.0) < 0.1 else "takes longer" if turns > both else "is faster"


def _duration(runs: Mapping[str, Run]) -> str:
    return quantity(float(runs["turns/sound/quintic/turns"].config["trajectory"]["duration"]), "s")
