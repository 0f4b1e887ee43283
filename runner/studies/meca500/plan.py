"""Computed runs and calibrations of the Meca500 study, in addition to runs.yaml."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from runner.config.compose.compose import compose
from runner.controllers.force.admittance_filter import Admittance
from runner.controllers.stability import stiffest_wall
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel
from runner.study.grid import Overrides
from runner.study.grids import FILE, Grids
from runner.study.results import Parts, parts_of

GRIDS = Grids(Path(__file__).with_name(FILE))
REPORTED = GRIDS.value("step", "reported")  # s, between two reports of the real controller
SINE_CASES = GRIDS.levels("sine", "case", str)
FREQUENCIES = GRIDS.levels("sine", "environment.frequency", float)  # Hz
ORIENTATIONS = 100
_WALLS = "map/servos"
_PERIODS = (0.001, 0.005, 0.01, REPORTED)  # s


@cache
def law() -> Admittance:
    """Return the law of the stability map."""
    return law_in(compose(GRIDS.grid(_WALLS).with_).resolved)


def law_in(config: Mapping[str, Any]) -> Admittance:
    """Return the law of the axes in a config."""
    return Admittance(*(np.array(config["controller"][key]) for key in ("mass", "damping", "stiffness")))


def computed_runs() -> dict[Parts, Overrides]:
    """Return the runs whose overrides are computed, by the parts of their names."""
    return {**_map(), **_rests()}


def calibrations(given: Mapping[str, Overrides]) -> dict[str, Overrides]:
    """Return the overrides of every calibration by name; each draws from a separate seed.

    With one seed for all they would be the same draws rescaled, and what is counted over them one test. The level of a
    grid that is the base case is the base case itself, which is carried out once.
    """
    jobs: dict[str, Overrides] = {}
    seeds = 0
    for name, overrides in given.items():
        (_, procedure), (_, varied), *axes = GRIDS.parts[name]
        base = GRIDS.grid(f"{procedure}/{varied}").values.get("base") if axes else None
        if base is not None and base == float(axes[0][1]):
            jobs[name] = jobs[f"{procedure}/base"]
        else:
            jobs[name] = (*overrides, f"seed={seeds}")
            seeds += 1
    return jobs


def _map() -> dict[Parts, Overrides]:
    """Return the law of the stability map on ideal joints at walls about their bound, by period and share."""
    own_law, base, shares = law(), GRIDS.grid(_WALLS).with_, GRIDS.levels(_WALLS, "share", float)
    bounds = {period: stiffest_wall(own_law, period, 0, 0.0, 0) for period in _PERIODS}
    return {
        parts_of("map/kinematic/{period}/{share}", {"period": period, "share": share}): (
            *base,
            f"controller.period={period}",
            f"environment.stiffness={share * bound:.5g}",
        )
        for period, bound in bounds.items()
        for share in shares
    }


def _rests() -> dict[Parts, Overrides]:
    """Return the tool weighed at rest in postures inside the joint limits, turned by half a turn at most."""
    model = RobotModel(read_urdf(find_urdf("meca500.urdf"), {}), "flange")
    low, high = np.clip(model.position_limits, -np.pi, np.pi)
    homes = np.random.default_rng(0).uniform(low, high, (ORIENTATIONS, 6))
    jobs: dict[Parts, Overrides] = {}
    for number, home in enumerate(homes):
        posture = f"robot.home={home.round(6).tolist()}".replace(" ", "")
        seed = f"seed={number}"
        rest = parts_of("rest/{posture}", {"posture": number})
        jobs[rest] = ("experiment=meca500/weighing", posture, "wrist_sensor=mini40", seed)
    return jobs
