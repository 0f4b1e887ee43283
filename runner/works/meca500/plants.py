"""Whether the simulation can be trusted: the plants on the report's own case."""

from collections.abc import Mapping

from runner.reporting.document import Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.plant_agreement import describe_agreement, disagreement
from runner.reporting.quantities import number
from runner.reporting.run_values import apart, clock
from runner.store import Run
from runner.works.meca500.plan import STEPS


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
    panels = []
    for name, other in (("Runge-Kutta", runs["plants/rk4"]), ("the kinematic plant", exact)):
        series = [Series(f"{step:g} s", clock(run), apart(run, other, "tip")) for step in STEPS
                  for run in [runs[f"plants/{step}"]]]  # fmt: skip
        panels.append(Panel(f"PyBullet from {name}", "time (s)", "distance of the tips (m)", series))
    return Section(
        "Whether the simulation can be trusted",
        (
            Text(
                f"The tool goes around a circle within {exact.config['duration']:g} s, and is pushed aside on the way. "
                "On the kinematic plant joints go where they are told, up to their speed limits; PyBullet and "
                f"Runge-Kutta integrate the arm with its masses, on servos of {servo['stiffness']:g} N m/rad, in two "
                "ways that share no code."
            ),
            Text(describe_agreement(finest)),
            Curves(
                "Distance of the tips from plant to plant, by PyBullet's step.",
                panels,
                2,
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
