"""Comparison of two sets of link masses, and the effect on gravity torques."""

import xml.etree.ElementTree as ET
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.papers.study.measured import ROUNDING
from runner.papers.study.results import Runs
from runner.store import Run

_COUNT = 1000
_LIGHT = 0.1  # kg and N m, below which a share means little
_SETS = {"cad_closed": "CAD", "uniform_density": "meshes"}


def light() -> float:
    """Return the mass below which links are left out, in g."""
    return 1e3 * _LIGHT


def masses(runs: Runs) -> list[list[str | float]]:
    """Return the masses of each link that moves, and of all, in kg, their ratio, and the set of the larger one."""
    pairs = _masses(*(runs[f"inertials/{name}"] for name in _SETS))
    pairs["all moving ones"] = np.sum([*pairs.values()], axis=0)
    names = list(_SETS.values())
    return [[link, *pair.tolist(), pair.max() / pair.min(), names[pair.argmax()]] for link, pair in pairs.items()]


def postures() -> int:
    """Return in how many random postures gravity torques are compared."""
    return _COUNT


def torques(runs: Runs) -> list[list[str | float | None]]:
    """Return torques of gravity, how far the sets differ, peaks and limits in N m: a row for each joint."""
    first, second = (runs[f"inertials/{name}"] for name in _SETS)
    largest = zip(*_gravity(first, second), strict=True)
    return [
        [
            f"joint {joint}",
            *(number(float(torque), rounding=ROUNDING) for torque in both),
            *(run.median(f"peak_torque_q{joint}") for run in (first, second)),
            float(first.model.effort_limits[joint - 1]),
        ]
        for joint, both in enumerate(largest, start=1)
    ]


def difference(first: Run, second: Run) -> dict[str, Any]:
    """Return the link whose masses differ most, the light ones left out, and how far the two sets differ, in per cent.

    mass is by how much its larger mass exceeds the smaller, gravity the largest difference of gravity torques over the
    joint's largest.
    """
    excess = {
        link: pair.max() / pair.min() - 1.0 for link, pair in _masses(first, second).items() if max(pair) > _LIGHT
    }
    link = max(excess, key=lambda name: excess[name])
    held, more = _gravity(first, second)
    share = more[held > _LIGHT] / held[held > _LIGHT]
    return {"link": link, "mass": 100.0 * excess[link], "gravity": 100.0 * float(share.max())}


def _masses(*runs: Run) -> dict[str, FloatArray]:
    """Return the masses in some runs' URDF of each link that moves, by its name, in kg."""
    sets = [ET.fromstring(run.urdf).findall("link[inertial]") for run in runs]  # noqa: S314 - our own text
    return {
        name: np.array([float(link.find("inertial/mass").get("value")) for link in links])
        for links in zip(*sets, strict=True)
        if (name := str(links[0].get("name"))).startswith("link")
    }


def _gravity(first: Run, second: Run) -> tuple[FloatArray, FloatArray]:
    """Return the largest gravity torque of the first set at random postures, and the largest difference, in N m."""
    low, high = np.clip(first.model.position_limits, -np.pi, np.pi)
    drawn = np.random.default_rng(0).uniform(low, high, (_COUNT, first.model.nq))
    one, other = (np.array([run.model.gravity_torque(q) for q in drawn]) for run in (first, second))
    return np.abs(one).max(axis=0), np.abs(other - one).max(axis=0)
