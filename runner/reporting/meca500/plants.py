"""Whether the simulation can be trusted: the plants on the report's own case."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, FloatArray, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.meca500.plan import STEPS
from runner.reporting.plant_agreement import describe_agreement, disagreement
from runner.reporting.quantities import number
from runner.reporting.thesis.studies import apart, clock
from runner.store import Run


def plants_section(runs: Mapping[str, Run]) -> Section:
    """Return a circle under a push on PyBullet, on Runge-Kutta and on the kinematic plant, and how far they part."""
    finest, exact = runs[f"plants/{STEPS[-1]}"], runs["plants/kinematic"]
    servo = finest.config["plant"]["servo"]
    rows = []
    for step in STEPS:
        run = runs[f"plants/{step}"]
        rows.append(
            [
                f"{step:g}",
                number(disagreement(run, runs["plants/rk4"]).tip),
                number(float(apart(run, exact, "tip").max())),
            ]
        )
    series = [
        Series("bullet", clock(finest), _way(finest), "line"),
        Series("rk4", clock(runs["plants/rk4"]), _way(runs["plants/rk4"]), "dashed"),
        Series("kinematic", clock(exact), _way(exact), "dotted"),
    ]
    return Section(
        "Whether the simulation can be trusted",
        (
            Text(
                "The tool goes around a circle within a second, and is pushed aside on the way. On the kinematic plant "
                "joints go where they are told, up to their speed limits; PyBullet and Runge-Kutta integrate the arm "
                f"with its masses, on servos of {servo['stiffness']:g} N m/rad, in two ways that share no code."
            ),
            Text(describe_agreement(finest)),
            Curves(
                "How far the tip gives way to the push, on the three plants.",
                (Panel("Distance from the circle's goal", "time (s)", "distance (m)", series),),
                1,
                origin(finest),
            ),
            Table(
                f"PyBullet by its step, against Runge-Kutta at {runs['plants/rk4'].provenance['plant_step']:g} s and "
                "against joints that go where they are told.",
                ["PyBullet's step (s)", "tip from Runge-Kutta (m)", "tip from the kinematic plant (m)"],
                rows,
                (0, 1, 2),
                origin(runs[f"plants/{STEPS[0]}"]),
            ),
        ),
    )


def _way(run: Run) -> FloatArray:
    """Return the tip's distance from the desired one, shape (T,), in m."""
    distance: FloatArray = np.linalg.norm(columns(run.trace, "error"), axis=1)
    return distance
