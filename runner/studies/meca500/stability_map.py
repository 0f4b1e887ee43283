"""Stability map of a sampled admittance over wall stiffness: linear prediction and simulated runs."""

import json
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from runner.base.quantities import number
from runner.config.composed import Composed
from runner.config.validation import validate
from runner.controllers.stability import stiffest_wall
from runner.metrics.caveats.contact_stability import servo_contact
from runner.plants.servo_contact_stability import ServoContact, contact_radius, stiffest_servo_wall
from runner.reporting.document import Panel, Series
from runner.store import Run
from runner.studies.meca500.figures import bounces, law_of, once
from runner.studies.meca500.plan import law
from runner.study.results import Runs, found


@once
def contact(run: Run) -> dict[str, float]:
    """Return predictions for a run at a wall, and its observed outcome.

    Stiffnesses in N/m: wall, ideal and late, the bounds of ideal joints that act at once or a tick late, and bound,
    that of the run's own joints. Ratios: over, wall to bound; rule, ideal to 2 B / h; behind, bound to ideal; off is
    how far the wall is from the bound, in per cent. radius is the spectral radius of the loop behind servos, and
    saturated the largest fraction of ticks that one of them is at its limit. The rest is true or not: that it
    is beyond the bound, that it bounces, that the one says the other, and both.
    """
    own_law, wall = law_of(run), float(run.config["environment"]["stiffness"])
    period = float(run.config["controller"]["period"])
    ideal, late = (stiffest_wall(own_law, period, 0, 0.0, delay) for delay in (0, 1))
    bound, radius = ideal, np.nan
    if run.config["plant"]["kind"] != "kinematic":
        q = tuple(run.joints("q")[0].tolist())
        radius = contact_radius(_loop(run.config, q))
        any_wall = {**run.config, "environment": {**run.config["environment"], "stiffness": 1.0}}
        bound = _bound(json.dumps(any_wall, sort_keys=True), q)
    beyond, bouncing = radius > 1.0 if np.isfinite(radius) else wall > bound, bounces(run)
    shares = (run.values(name)[0] for name in run.metrics if name.startswith("saturation_fraction_q"))
    return {
        "wall": wall,
        "ideal": ideal,
        "late": late,
        "bound": bound,
        "over": wall / bound,
        "rule": ideal * period / (2.0 * float(own_law.damping[0])),
        "behind": bound / ideal,
        "off": 100.0 * abs(wall / bound - 1.0),
        "radius": radius,
        "saturated": float(max(shares)),
        "beyond": beyond,
        "right": bouncing == beyond,
        "both": bouncing and beyond,
        "wrong": bouncing and not beyond,
        "calm": not bouncing and not beyond,
    }


def bound_at(delay: int) -> Callable[[float], float]:
    """Return the stiffest wall of ideal joints that act so many ticks late over the sample time in ms, in N/m."""
    return lambda period: stiffest_wall(law(), 1e-3 * period, 0, 0.0, delay)


def stiffest_stable(*cases: Run) -> str:
    """Return the stiffest wall of some runs that do not bounce."""
    walls = [contact(run)["wall"] for run in cases if not bounces(run)]
    return number(max(walls)) if walls else "none"


def softest_unstable(*cases: Run) -> str:
    """Return the softest wall of some runs that bounce."""
    walls = [contact(run)["wall"] for run in cases if bounces(run)]
    return number(min(walls)) if walls else "none"


def as_predicted(*cases: Run) -> str:
    """Return the number of runs that bounce or not as predicted, out of all given, as text."""
    return f"{sum(contact(run)['right'] for run in cases):g} of {len(cases)}"


def outcomes(runs: Runs, pattern: str, x: Callable[[Run], float], y: Callable[[Run], float]) -> list[Series]:
    """Return the runs that a pattern stands for as points over two of their numbers, stable and unstable ones apart."""
    series = []
    for bouncing, name in ((False, "stable"), (True, "unstable")):
        points = [(x(each.run), y(each.run)) for each in found(runs, pattern) if bounces(each.run) == bouncing]
        over, value = np.array(points, dtype=float).reshape(-1, 2).T
        series.append(Series(name, over, value, "points"))
    return series


def servo_panels(runs: Runs, pattern: str, x: Callable[[Run], float], y: Callable[[Run], float]) -> list[Panel]:
    """Return the spectral radius over the wall's stiffness, for each case of servos."""
    panels = []
    for case in dict.fromkeys(each.levels["case"] for each in found(runs, pattern)):
        own = pattern.replace("{case}", case)
        walls = [x(each.run) for each in found(runs, own)]
        level = Series("predicted bound", np.array([min(walls), max(walls)]), np.ones(2), "line")
        series = [level, *outcomes(runs, own, x, y)]
        panels.append(Panel(f"{case} N m/rad", "wall stiffness (N/m)", "spectral radius", series))
    return panels


def _loop(config: Mapping[str, Any], q: tuple[float, ...]) -> ServoContact:
    loop = servo_contact(validate(Composed(config)), np.array(q))
    assert loop is not None  # noqa: S101 - the plan's runs have servos, a law and a wall
    return loop


@lru_cache(maxsize=64)
def _bound(config: str, q: tuple[float, ...]) -> float:
    return stiffest_servo_wall(_loop(json.loads(config), q)) or np.nan
