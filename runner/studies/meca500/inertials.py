"""Comparison of two sets of link masses, and the effect on gravity torques."""

import xml.etree.ElementTree as ET
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import number
from runner.store import Run
from runner.study.measured import ROUNDING
from runner.study.results import Runs

_COUNT = 1000
_LIGHT = 0.1  # kg and N m, below which a share means little
_SETS = {"cad_closed": "CAD", "uniform_density": "meshes"}


def light() -> float:
    """Return the mass below which links are left out, in g."""
    return 1e3 * _LIGHT


def masses(runs: Runs) -> list[list[str]]:
    """Return the masses of each link that moves, and of all, in kg, their ratio, and the set of the larger one."""
    first, second = (runs[f"inertials/{name}"] for name in _SETS)
    pairs = _moving(first, second)
    pairs["all moving ones"] = (sum(pair[0] for pair in pairs.values()), sum(pair[1] for pair in pairs.values()))
    return [
        [link, number(a), number(b), number(max(a, b) / min(a, b)), list(_SETS.values())[int(b > a)]]
        for link, (a, b) in pairs.items()
    ]


def postures() -> int:
    """Return in how many random postures gravity torques are compared."""
    return _COUNT


def torques(runs: Runs) -> list[list[str]]:
    """Return torques of gravity, how far the sets differ, peaks and limits in N m: a row for each joint."""
    first, second = (runs[f"inertials/{name}"] for name in _SETS)
    held, more = _gravity(first), _gravity(second) - _gravity(first)
    return [
        [
            f"joint {joint + 1}",
            *(number(float(np.abs(torque[:, joint]).max()), rounding=ROUNDING) for torque in (held, more)),
            *(number(run.median(f"peak_torque_q{joint + 1}")) for run in (first, second)),
            number(float(first.model.effort_limits[joint])),
        ]
        for joint in range(6)
    ]


def difference(first: Run, second: Run) -> dict[str, Any]:
    """Return the link whose masses differ most, the light ones left out, and how far the two sets differ, in per cent.

    mass is by how much its larger mass exceeds the smaller, gravity the largest difference of gravity torques over the
    joint's largest.
    """
    excess = {link: max(pair) / min(pair) - 1.0 for link, pair in _moving(first, second).items() if max(pair) > _LIGHT}
    link = max(excess, key=lambda name: excess[name])
    held, other = _gravity(first), _gravity(second)
    largest = np.abs(held).max(axis=0)
    share = np.abs(other - held).max(axis=0)[largest > _LIGHT] / largest[largest > _LIGHT]
    return {"link": link, "mass": 100.0 * excess[link], "gravity": 100.0 * float(share.max())}


def _moving(first: Run, second: Run) -> dict[str, tuple[float, float]]:
    """Return both masses of each link that moves, by its name, in kg."""
    one, other = _masses(first), _masses(second)
    return {link: (one[link], other[link]) for link in one if link.startswith("link")}


def _masses(run: Run) -> dict[str, float]:
    """Return the mass of each link of a run's URDF, in kg."""
    links = ET.fromstring(run.urdf).iter("link")  # noqa: S314 - our own text
    found = {str(link.get("name")): link.find("inertial/mass") for link in links}
    return {name: float(mass.get("value", "0")) for name, mass in found.items() if mass is not None}


def _gravity(run: Run) -> FloatArray:
    """Return gravity torques at random postures, the same for every run, shape (count, nq), in N m."""
    model = run.model
    low, high = np.clip(model.position_limits, -np.pi, np.pi)
    postures = np.random.default_rng(0).uniform(low, high, (_COUNT, run.joints("q").shape[1]))
    return np.array([model.gravity_torque(q) for q in postures])
