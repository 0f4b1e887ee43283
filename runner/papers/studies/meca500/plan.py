"""Computed runs and calibrations of the Meca500 study, in addition to runs.yaml."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from runner.controllers.force.admittance_filter import Admittance
from runner.papers.study.grid import Overrides
from runner.papers.study.grids import FILE, Grids
from runner.papers.study.results import Parts, parts_of
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel

GRIDS = Grids(Path(__file__).with_name(FILE))
_ORIENTATIONS = 100


def law_in(config: Mapping[str, Any]) -> Admittance:
    """Return the law of the axes in a config."""
    return Admittance(*(np.array(config["controller"][key]) for key in ("mass", "damping", "stiffness")))


def computed_runs() -> dict[Parts, Overrides]:
    """Return the tool weighed at rest in postures inside the joint limits, turned by half a turn at most."""
    model = RobotModel(read_urdf(find_urdf("meca500.urdf"), {}), "flange")
    low, high = np.clip(model.position_limits, -np.pi, np.pi)
    homes = np.random.default_rng(0).uniform(low, high, (_ORIENTATIONS, 6))
    jobs: dict[Parts, Overrides] = {}
    for number, home in enumerate(homes):
        posture = f"robot.home={home.round(6).tolist()}".replace(" ", "")
        rest = parts_of("rest/{posture}", {"posture": number})
        jobs[rest] = ("experiment=meca500/weighing", posture, "wrist_sensor=mini40", f"seed={number}")
    return jobs


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
