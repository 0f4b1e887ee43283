"""Contact with walls of known stiffness: the force that is read against the true one."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import clock
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.meca500.plan import PLANTS, WALLS
from runner.works.meca500.servo_compliance import servo_compliance
from runner.works.meca500.signals import wrenches
from runner.works.meca500.step_response import law_of


def contact_section(runs: Mapping[str, Run]) -> Section:
    """Return the forces at walls, felt and true, and against springs in series."""
    walls = {(plant, k): runs[f"wall/{plant}/{k:g}"] for plant in PLANTS for k in WALLS}
    rows = [
        [
            in_words(plant),
            number(stiffness),
            number(felt_force(run), 5),
            number(100.0 * reading_error(run), rounding=100.0 * ROUNDING),
            number(_in_series(run), 5),
            number(100.0 * (felt_force(run) / _in_series(run) - 1.0), 2, rounding=100.0 * ROUNDING),
            number(peak_force(run)),
        ]
        for (plant, stiffness), run in walls.items()
    ]
    first = walls["kinematic", 1e3]
    law, way = law_of(first), _way(first)
    return Section(
        "Contact with a wall",
        (
            Text(
                f"The spring's rest is led {1e3 * way:g} mm into a wall at the tip. On the kinematic plant the wall is "
                "a spring and a damper at the tip; in PyBullet it is a body that gives way, and its contact solver "
                "makes the force. The true force is the wall's stiffness $k$ times the depth of the true tip; at rest "
                "it is that of springs in series, the law's, the wall's, and, where the joints have servos, theirs "
                "with compliance $C$:"
            ),
            Formula(
                'F = delta / (1 / K + 1 / k + C_(x x)) quad (C_(x x) = 0 "on the kinematic plant")',
                "F equals delta over one over K plus one over k plus C x x",
            ),
            _curves(runs),
            Table(
                f"Force at rest on the wall, with $K = {law.stiffness[0]:g}$ N/m and $B = {law.damping[0]:g}$ N s/m.",
                [
                    "plant",
                    "wall (N/m)",
                    "force felt (N)",
                    "off the true force (%)",
                    "springs in series (N)",
                    "off that (%)",
                    "peak (N)",
                ],
                rows,
                tuple(range(1, 7)),
                origin(first),
            ),
            contact_finding(**contact_values(runs)),
        ),
    )


def contact_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on contact is about."""
    walls = {(plant, k): runs[f"wall/{plant}/{k:g}"] for plant in PLANTS for k in WALLS}
    series = max(abs(felt_force(run) / _in_series(run) - 1.0) for run in walls.values())
    first = min(peak_force(run) / felt_force(run) for run in walls.values())
    softer = max(peak_force(walls["bullet", k]) / peak_force(walls["kinematic", k]) for k in WALLS)
    return {
        "softest": Measured("stiffness of the softest wall", min(WALLS), "N/m"),
        "stiffest": Measured("stiffness of the stiffest wall", max(WALLS), "N/m"),
        "reading": Measured("largest distance of the force felt from stiffness times depth", _worst(walls), "%"),
        "series": Measured("largest distance of the force felt from springs in series", 100.0 * series, "%"),
        "first": Measured("least ratio of the peak to the force at rest", first),
        "softer": Measured("largest ratio of the peaks with servos and without", softer),
    }


def contact_finding(
    softest: Measured, stiffest: Measured, reading: Measured, series: Measured, first: Measured, softer: Measured
) -> Finding:
    """Return what walls of known stiffness say of the force that is felt."""
    return finding(
        "The force that is felt is the true one",
        f"From {softest} to {stiffest} the force felt at rest is within {reading} of stiffness times depth, on both "
        f"plants, and within {series} of the springs in series. The first touch is harder than what stays, {first} "
        f"times or more; behind servos it is softer than where joints go as they are told, {softer} times or less.",
        reading < 1e-3,
        series < 0.2,
        first > 1.2,
        softer < 0.98,
    )


def _worst(walls: Mapping[tuple[str, float], Run]) -> float:
    return 100.0 * max(reading_error(run) for run in walls.values())


def peak_force(run: Run) -> float:
    """Return the wall's largest push against the way in, in N."""
    return float(-wrenches(run, "external")[:, 0].min())


def felt_force(run: Run) -> float:
    """Return the wall's push against the way in as it is felt at the end of a run, in N."""
    return float(-wrenches(run, "felt")[-1, 0])


def reading_error(run: Run) -> float:
    """Return how far the force felt at the end is off the wall's stiffness times the tip's depth, as a share of it."""
    return abs(felt_force(run) / _by_depth(run) - 1.0)


def _way(run: Run) -> float:
    trajectory = run.config["trajectory"]
    return float(trajectory["goal"][0] - trajectory["start"][0] - run.config["environment"]["distance"])


def _by_depth(run: Run) -> float:
    wall = float(run.config["trajectory"]["start"][0] + run.config["environment"]["distance"])
    return float(run.config["environment"]["stiffness"]) * (float(columns(run.trace, "tip")[-1, 0]) - wall)


def _in_series(run: Run) -> float:
    soft = servo_compliance(run)[0, 0] if run.config["plant"]["kind"] == "bullet" else 0.0
    springs = 1.0 / law_of(run).stiffness[0] + 1.0 / float(run.config["environment"]["stiffness"])
    return float(_way(run) / (springs + soft))


def _curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for plant in PLANTS:
        series = []
        for color, stiffness in enumerate(WALLS):
            run = runs[f"wall/{plant}/{stiffness:g}"]
            felt = np.append(-wrenches(run, "felt")[1:, 0], np.nan)  # felt of the reading a tick before
            true = -wrenches(run, "external")[:, 0]
            series.append(Series(f"{number(stiffness)} N/m, true", clock(run), true, "line", color=color))
            series.append(Series("felt", clock(run), felt, "dotted", color=color))
        panels.append(
            Panel(
                in_words(plant).capitalize() if plant == "kinematic" else in_words(plant),
                "time (s)",
                "force (N)",
                series,
                x_range=(0.0, 0.6),
            )
        )
    return Curves("Force of the wall, true and felt.", panels, 2, origin(runs["wall/kinematic/1000"]))
