"""Whether the simulation can be trusted: the two plants on the report's own case."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from runner.reporting.document import Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.plant_agreement import describe_agreement, disagreement
from runner.reporting.quantities import above_rounding, number
from runner.reporting.run_values import measured
from runner.reporting.words import PLANT, PRESET
from runner.store import Run
from runner.works.xarm7.plan import STEPS


def plants_section(runs: Mapping[str, Run]) -> Section:
    """Return the line by three joints with servos, on PyBullet and on Runge-Kutta, and how far they are apart."""
    servo = runs[f"servo/sound/{STEPS[-1]}"]
    settings = servo.config["plant"]["servo"]
    sentences = [
        f"{PRESET[preset].capitalize()}: {describe_agreement(runs[f'servo/{preset}/{STEPS[-1]}'])}"
        for preset in PRESETS
    ]
    return Section(
        "Whether the simulation can be trusted",
        (
            Text(
                "The figures of the two parts come from joints that reach every command, as nothing else is known "
                f"of the report's. Here the same commands go to joint servos of {settings['stiffness']:g} N m/rad, "
                f"damping ratio {settings['damping_ratio']:g}, on an arm with mass. PyBullet and Runge-Kutta "
                "integrate its motion in two ways that share no code."
            ),
            Text(" ".join(sentences)),
            _plants(runs),
            _steps(runs),
            _concluded(runs),
        ),
    )


def _concluded(runs: Mapping[str, Run]) -> Finding:
    return conclude(
        [
            [
                Measured(
                    f"largest tip distance, {PRESET[preset]}, {1e3 * step:g} ms",
                    disagreement(runs[f"servo/{preset}/{step}"], runs[f"servo/{preset}/rk4"]).tip,
                    "m",
                )
                for step in STEPS
            ]
            for preset in PRESETS
        ],
        [
            measured(runs[f"servo/{preset}/{STEPS[-1]}"], "max_tracking_error", f"tip error, {PRESET[preset]}")
            for preset in PRESETS
        ],
    )


def conclude(distances: Sequence[Sequence[Measured]], errors: Sequence[Measured]) -> Finding:
    """Return how the plants come together.

    Args:
        distances: Largest distance of the tips by preset and PyBullet's step, from the largest step on.
        errors: Tip error by preset with the smallest step.
    """
    finest = [each[-1] for each in distances]
    return finding(
        "The plants come together with PyBullet's step",
        f"Halving PyBullet's step halves the largest distance of the tips, down to {finest[0]} (as reported) and "
        f"{finest[1]} (full equations) at {1e3 * STEPS[-1]:g} ms: what is left is the error of its step, which is of "
        f"first order. The tip errors themselves are larger by far, {errors[0]} and {errors[1]}.",
        *((finer / coarser).near(0.5, 0.1) for each in distances for coarser, finer in pairwise(each)),
        *(error > 50.0 * distance for error, distance in zip(errors, finest, strict=True)),
    )


def _plants(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for preset in PRESETS:
        series = []
        for name, run in (("bullet", STEPS[-1]), ("rk4", "rk4")):
            trace = runs[f"servo/{preset}/{run}"].trace
            error = np.linalg.norm(columns(trace, "error"), axis=1)
            series.append(Series(PLANT[name], trace["t"].to_numpy(), error, "line" if name == "bullet" else "dashed"))
        panels.append(Panel(PRESET[preset].capitalize(), "time (s)", "error norm (m)", series))
    return Curves(
        "Tip error from A to B by three joints with servos, on both plants.",
        panels,
        2,
        origin(runs[f"servo/as_reported/{STEPS[-1]}"]),
    )


def _steps(runs: Mapping[str, Run]) -> Table:
    rows = []
    for preset in PRESETS:
        for step in STEPS:
            run = runs[f"servo/{preset}/{step}"]
            apart = disagreement(run, runs[f"servo/{preset}/rk4"])
            rows.append(
                [
                    PRESET[preset],
                    number(step),
                    above_rounding(apart.tip),
                    number(run.metrics["max_tracking_error"]["median"]),
                ]
            )
    return Table(
        f"PyBullet's step against Runge-Kutta at {runs['servo/sound/rk4'].provenance['plant_step']:g} s.",
        ["preset", "PyBullet's step (s)", "largest tip distance (m)", "tracking error (m)"],
        rows,
        (1, 2, 3),
        origin(runs[f"servo/as_reported/{STEPS[0]}"]),
    )
