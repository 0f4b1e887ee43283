"""Stability map of a sampled admittance over wall stiffness: linear prediction and simulated runs."""

import json
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from runner.assembly.validation import validate
from runner.caveats.contact_stability import servo_contact
from runner.caveats.servo_contact_stability import ServoContact, contact_radius, stiffest_servo_wall
from runner.config.composed import Composed
from runner.controllers.stability import stiffest_wall
from runner.papers.studies.meca500.figures import bounces, once
from runner.papers.studies.meca500.plan import law_in
from runner.papers.study.results import Runs
from runner.store import Run


@once
def contact(run: Run) -> dict[str, float]:
    """Return predictions for a run at a wall, and its observed outcome.

    Stiffnesses in N/m: ideal and late, the bounds of ideal joints that act at once or a tick late, and bound, that of
    the run's own joints. radius is the spectral radius of the loop behind servos, and saturated the largest fraction of
    ticks that one of them is at its limit. The rest is true or not: that it is beyond the bound, that it bounces as
    predicted, that it bounces though it should not, that it does both, and neither.
    """
    period, wall = float(run.config["controller"]["period"]), float(run.config["environment"]["stiffness"])
    ideal, late = (stiffest_wall(law_in(run.config), period, 0, 0.0, delay) for delay in (0, 1))
    bound, radius, beyond = ideal, np.nan, wall > ideal
    if run.config["plant"]["kind"] != "kinematic":
        q = tuple(run.joints("q")[0].tolist())
        radius = contact_radius(_loop(run.config, q))
        any_wall = {**run.config, "environment": {**run.config["environment"], "stiffness": 1.0}}
        bound, beyond = _bound(json.dumps(any_wall, sort_keys=True), q), radius > 1.0
    bouncing = bounces(run)
    shares = (run.values(name)[0] for name in run.metrics if name.startswith("saturation_fraction_q"))
    return {
        "ideal": ideal,
        "late": late,
        "bound": bound,
        "radius": radius,
        "saturated": float(max(shares)),
        "beyond": beyond,
        "right": bouncing == beyond,
        "both": bouncing and beyond,
        "wrong": bouncing and not beyond,
        "calm": not bouncing and not beyond,
    }


def bound_at(runs: Runs, run: str, delay: int) -> Callable[[float], float]:
    """Return the stiffest wall, in N/m, of ideal joints that many ticks late under a run's law, by period in ms."""
    law = law_in(runs[run].config)
    return lambda period: stiffest_wall(law, 1e-3 * period, 0, 0.0, delay)


def outcome(run: Run) -> str:
    """Return the outcome of contact as a cell of a table."""
    return "bounces" if bounces(run) else "stable"


def _loop(config: Mapping[str, Any], q: tuple[float, ...]) -> ServoContact:
    loop = servo_contact(validate(Composed(config)), np.array(q))
    assert loop is not None  # noqa: S101 - the plan's runs have servos, a law and a wall
    return loop


@lru_cache(maxsize=64)
def _bound(config: str, q: tuple[float, ...]) -> float:
    return stiffest_servo_wall(_loop(json.loads(config), q)) or np.nan
