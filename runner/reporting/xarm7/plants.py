"""Whether the simulation can be trusted: the two plants on the report's own case."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.job import PRESETS
from runner.reporting.plant_agreement import describe_agreement, disagreement
from runner.reporting.quantities import number
from runner.reporting.xarm7.plan import STEPS
from runner.store import Run


def plants_section(runs: Mapping[str, Run]) -> Section:
    """Return the line by three joints with servos, on PyBullet and on Runge-Kutta, and how far they are apart."""
    servo = runs[f"servo/sound/{STEPS[-1]}"]
    settings = servo.config["plant"]["servo"]
    sentences = [f"Preset {preset}: {describe_agreement(runs[f'servo/{preset}/{STEPS[-1]}'])}" for preset in PRESETS]
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
        ),
    )


def _plants(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for preset in PRESETS:
        series = []
        for name, run in (("bullet", STEPS[-1]), ("rk4", "rk4")):
            trace = runs[f"servo/{preset}/{run}"].trace
            error = np.linalg.norm(columns(trace, "error"), axis=1)
            series.append(Series(name, trace["t"].to_numpy(), error, "line" if name == "bullet" else "dashed"))
        panels.append(Panel(f"Preset {preset}", "time (s)", "error norm (m)", series))
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
            rows.append([preset, f"{step:g}", number(apart.tip), number(run.metrics["max_tracking_error"]["median"])])
    return Table(
        f"PyBullet's step against Runge-Kutta at {runs['servo/sound/rk4'].provenance['plant_step']:g} s.",
        ["preset", "PyBullet's step (s)", "largest tip distance (m)", "tracking error (m)"],
        rows,
        (1, 2, 3),
        origin(runs[f"servo/as_reported/{STEPS[0]}"]),
    )
