"""Decoupled against coupled dynamics: is the coupling that the thesis neglects negligible?"""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import apart, cell, clock, failures, median
from runner.reporting.thesis.combined_plan import METHODS, MOTIONS
from runner.reporting.thesis.studies import largest, settled
from runner.reporting.thesis.vanishing_mass import vanishing_section
from runner.store import Run

_SHOWN = ("one_way", "two_way", "mini_held", "whole_body")
_METRICS = {"goal": ("settling_time", "steady_state_error"), "quintic": ("max_tracking_error", "steady_state_error")}
_TITLES = {"goal": "goal position", "quintic": "tracking, $t_f = 3$ s"}


def coupling_section(runs: Mapping[str, Run]) -> Section:
    """Return every controller on both plants, and what remains of the coupling as the Mini's mass vanishes."""
    ours = {name: run for name, run in runs.items() if name.startswith("coupling/")}
    blocks: list[Block] = [
        Text(
            "The thesis simulates each arm with its own dynamics: the Macro feels no Mini, and the Mini's base is "
            "carried without inertial forces. Here the same controllers (preset sound, thesis torque limits, no "
            "noise) run on that decoupled plant and on the whole arm."
        )
    ]
    for motion in MOTIONS:
        blocks += [_table(runs, motion), _verdict(runs, motion)]
    blocks.append(_curves(runs))
    blocks += failures(ours)
    return Section("Decoupled against coupled dynamics", blocks, (vanishing_section(runs),))


def _pair(runs: Mapping[str, Run], motion: str, method: str) -> tuple[Run, Run]:
    return runs[f"coupling/{motion}/{method}/coupled"], runs[f"coupling/{motion}/{method}/decoupled"]


def _table(runs: Mapping[str, Run], motion: str) -> Table:
    rows = []
    for method in METHODS:
        pair = _pair(runs, motion, method)
        distances = [number(largest(apart(*pair, signal))) for signal in ("tip", "macro_tip")]
        measured = [
            f"{settled(run) if metric == 'settling_time' else cell(run, metric)}"
            for metric in _METRICS[motion]
            for run in pair
        ]
        rows.append([method, *distances, *measured])
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


def _verdict(runs: Mapping[str, Run], motion: str) -> Notice:
    """Return who may neglect the coupling: controllers whose tip it moves less than the encoders' noise does."""
    noisy = runs[f"coupling/{motion}/noise"]
    exact = _pair(runs, motion, "one_way")[0]
    yardstick = largest(apart(noisy, exact, "tip"))
    changes = {method: largest(apart(*_pair(runs, motion, method), "tip")) for method in METHODS}
    small = [m for m, change in changes.items() if change is not None and yardstick and change < yardstick]
    large = [m for m in METHODS if m not in small]
    who = "no controller" if not small else "every controller" if not large else ", ".join(small)
    but = f", not for {', '.join(large)}" if small and large else ""
    title = f"The coupling is negligible for {who}{but}"
    rest = median(exact, "macro_steady_state_error") if motion == "quintic" else None
    sag = (
        f" At rest the Mini's weight, unknown to the Macro, displaces its end point by {quantity(rest, 'm')}, which "
        "the Mini makes up for and a Mini held still does not."
        if rest
        else ""
    )
    return Notice(
        "finding",
        f"{title} ({'goal position' if motion == 'goal' else 'tracking'})",
        "Taken as negligible: the coupling moves the tip by less than the thesis' encoder noise does with one-way "
        f"control on the same motion, {quantity(yardstick, 'm')} at most. The coupling moves it by "
        + ", ".join(f"{quantity(change, 'm', 2)} ({method})" for method, change in changes.items())
        + f". At the end of the run {_ends(runs, motion)}."
        + sag,
    )


def _ends(runs: Mapping[str, Run], motion: str) -> str:
    """Return how far apart the tips are at the end of the run, in words."""
    left = {method: float(apart(*_pair(runs, motion, method), "tip")[-1]) for method in METHODS}
    return "the tips are " + ", ".join(f"{quantity(left[method], 'm', 2)} ({method})" for method in METHODS) + " apart"


def _curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for motion in MOTIONS:
        series = []
        for method in _SHOWN:
            pair = _pair(runs, motion, method)
            distance = apart(*pair, "tip")
            t = clock(pair[0])[: len(distance)]
            series.append(Series(method, t, np.where(distance > 0.0, distance, np.nan)))
        title = "Goal position" if motion == "goal" else "Tracking"
        panels.append(Panel(title, "time (s)", "tips apart (m)", series, y_log=True, y_range=(1e-8, 10.0)))
    return Curves(
        "Distance between the tips of the coupled and the decoupled arm over time. Saturated joints amplify a small "
        "difference; feedback takes it back.",
        panels,
        2,
        origin(_pair(runs, "goal", "one_way")[0]),
    )
