"""Decoupled against coupled dynamics: is the coupling that the thesis neglects negligible?"""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import above_rounding
from runner.reporting.run_values import apart, cell, clock, failures, measured
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.thesis.plan import METHODS, MOTIONS
from runner.works.thesis.studies import largest, settled
from runner.works.thesis.vanishing_mass import vanishing_section

_SHOWN = ("one_way", "two_way", "mini_held", "whole_body")
_METRICS = {"goal": ("settling_time", "steady_state_error"), "quintic": ("max_tracking_error", "steady_state_error")}
_TITLES = {"goal": "goal position", "quintic": "tracking, $t_f = 3$ s"}


def coupling_section(runs: Mapping[str, Run]) -> Section:
    """Return every controller on both plants, and what remains of the coupling as the Mini's mass vanishes."""
    ours = {name: run for name, run in runs.items() if name.startswith("coupling/")}
    blocks: list[Block] = [
        Text(
            "The thesis simulates each arm with its own dynamics: the Macro feels no Mini, and the Mini's base is "
            "carried without inertial forces. Here the same controllers (full equations, thesis torque limits, no "
            "noise) run on that decoupled plant and on the whole arm."
        )
    ]
    for motion in MOTIONS:
        blocks += [_table(runs, motion), _FINDINGS[motion](runs)]
    blocks.append(_curves(runs))
    blocks += failures(ours)
    return Section("Decoupled against coupled dynamics", blocks, (vanishing_section(runs),))


def _pair(runs: Mapping[str, Run], motion: str, method: str) -> tuple[Run, Run]:
    return runs[f"coupling/{motion}/{method}/coupled"], runs[f"coupling/{motion}/{method}/decoupled"]


def _table(runs: Mapping[str, Run], motion: str) -> Table:
    rows = []
    for method in METHODS:
        pair = _pair(runs, motion, method)
        distances = [above_rounding(largest(apart(*pair, signal))) for signal in ("tip", "macro_tip")]
        measured = [
            settled(run) if metric == "settling_time" else cell(run, metric)
            for metric in _METRICS[motion]
            for run in pair
        ]
        rows.append([in_words(method), *distances, *measured])
    first, unit = ("settling time", "s") if motion == "goal" else ("largest error", "m")
    header = [
        "controller",
        "tips apart (m)",
        "Macro end points apart (m)",
        f"{first}, coupled ({unit})",
        f"decoupled ({unit})",
        "steady error, coupled (m)",
        "decoupled (m)",
    ]
    return Table(
        "Largest distance at equal times between the coupled and the decoupled arm, and their metrics: "
        f"{_TITLES[motion]}.",
        header,
        rows,
        tuple(range(1, len(header))),
        origin(_pair(runs, motion, "one_way")[0]),
    )


def _goal(runs: Mapping[str, Run]) -> Finding:
    yardstick, changes = _changes(runs, "goal")
    return finding(
        "On the goal move no controller may neglect the coupling",
        f"{_YARDSTICK} {yardstick} at most. The coupling moves it by {_listed(changes)}. At the end of the run the "
        f"tips are {_listed(_ends(runs, 'goal'))} apart.",
        *(change > 2.0 * yardstick for change in changes.values()),
    )


def _quintic(runs: Mapping[str, Run]) -> Finding:
    yardstick, changes = _changes(runs, "quintic")
    ends = _ends(runs, "quintic")
    coupled, decoupled = _pair(runs, "quintic", "one_way")
    sag = measured(coupled, "macro_steady_state_error", "the Macro at rest, coupled")
    tip = measured(coupled, "steady_state_error", "the tip at rest, coupled")
    return finding(
        "On the trajectory only one-way control may neglect the coupling",
        f"{_YARDSTICK} {yardstick} at most. The coupling moves it by {_listed(changes)}. At the end of the run the "
        f"tips are {_listed(ends)} apart: at rest the Mini's weight, unknown to the Macro, displaces its end point by "
        f"{sag}, which the Mini makes up for ({tip}) and a Mini held still does not.",
        changes["one_way"] < 0.5 * yardstick,
        *(changes[method] > 2.0 * yardstick for method in METHODS if method != "one_way"),
        measured(decoupled, "macro_steady_state_error", "the Macro at rest, decoupled") < 0.1 * sag,
        tip < 0.01 * sag,
        ends["mini_held"] > 0.5 * sag,
    )


_FINDINGS = {"goal": _goal, "quintic": _quintic}
_YARDSTICK = (
    "A controller may neglect the coupling where this moves the tip by less than the thesis' encoder noise does with "
    "one-way control on the same motion, which is"
)


def _changes(runs: Mapping[str, Run], motion: str) -> tuple[Measured, dict[str, Measured]]:
    """Return how far the encoders' noise moves the tip under one-way control, and how far the coupling moves it."""
    noise = largest(apart(runs[f"coupling/{motion}/noise"], _pair(runs, motion, "one_way")[0], "tip"))
    changes = {
        method: Measured(
            f"the coupling moves the tip ({in_words(method)}, {motion})",
            largest(apart(*_pair(runs, motion, method), "tip")),
            "m",
        )
        for method in METHODS
    }
    return Measured(f"noise moves the tip ({motion})", noise, "m"), changes


def _ends(runs: Mapping[str, Run], motion: str) -> dict[str, Measured]:
    """Return how far apart the tips are at the end of the run."""
    return {
        method: Measured(
            f"tips apart at the end ({in_words(method)}, {motion})",
            float(apart(*_pair(runs, motion, method), "tip")[-1]),
            "m",
        )
        for method in METHODS
    }


def _listed(lengths: Mapping[str, Measured]) -> str:
    return ", ".join(f"{length} ({in_words(method)})" for method, length in lengths.items())


def _curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for motion in MOTIONS:
        series = []
        for method in _SHOWN:
            pair = _pair(runs, motion, method)
            distance = apart(*pair, "tip")
            t = clock(pair[0])[: len(distance)]
            series.append(Series(in_words(method), t, np.where(distance > 0.0, distance, np.nan)))
        title = "Goal position" if motion == "goal" else "Tracking"
        panels.append(Panel(title, "time (s)", "tips apart (m)", series, y_log=True, y_range=(1e-8, 10.0)))
    return Curves(
        "Distance between the tips of the coupled and the decoupled arm over time.",
        panels,
        2,
        origin(_pair(runs, "goal", "one_way")[0]),
    )
