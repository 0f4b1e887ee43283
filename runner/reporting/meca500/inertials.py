"""How well the arm's masses are known, and what follows for its torques."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping

import numpy as np

from runner.reporting.document import FloatArray, Notice, Section, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.meca500.plan import INERTIALS
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import apart, median
from runner.store import Run

_COUNT = 1000
_LIGHT = 0.1  # kg and N m, below which a share means little


def inertials_section(runs: Mapping[str, Run]) -> Section:
    """Return the two sets of inertials side by side: masses, gravity torques over postures, torques of a motion."""
    first, second = (runs[f"inertials/{name}"] for name in INERTIALS)
    masses = [_masses(run) for run in (first, second)]
    moving = [link for link in masses[0] if link.startswith("link")]
    pairs = {link: (masses[0][link], masses[1][link]) for link in moving}
    worst = max((link for link in moving if max(pairs[link]) > _LIGHT), key=lambda link: _larger(pairs[link]))
    gravity = [_gravity(run) for run in (first, second)]
    loaded = [joint for joint in range(6) if np.abs(gravity[0][:, joint]).max() > _LIGHT]
    share = np.abs(gravity[1] - gravity[0]).max(axis=0)[loaded] / np.abs(gravity[0]).max(axis=0)[loaded]
    pairs["all that move"] = (sum(masses[0][link] for link in moving), sum(masses[1][link] for link in moving))
    rows = [[link, number(a), number(b), f"{100.0 * _larger((a, b)):.0f} %"] for link, (a, b) in pairs.items()]
    torque_rows = [
        [
            f"joint {joint + 1}",
            number(float(np.abs(gravity[0][:, joint]).max())),
            number(float(np.abs(gravity[1] - gravity[0])[:, joint].max())),
            number(median(first, f"peak_torque_q{joint + 1}")),
            number(median(second, f"peak_torque_q{joint + 1}")),
            number(float(model_of(first).effort_limits[joint])),
        ]
        for joint in range(6)
    ]
    return Section(
        "How well the arm is known",
        (
            Text(
                "The maker publishes no masses. Two sets are held, each named by robot.inertials and open to a sweep: "
                "cad_closed, CAD values of an unofficial description closed to the arm's weight, and uniform_density, "
                "the volumes of the maker's meshes times one density. The controller's own rigid-body model is that "
                "of the arm simulated, so that here only what the arm needs changes."
            ),
            Table(
                "Masses of the moving links, in kg.",
                ["link", *INERTIALS, "larger by"],
                rows,
                (1, 2, 3),
                origin(first),
            ),
            Table(
                f"Torques, in N m, with the tool: of gravity over {_COUNT} random postures, and peaks around a circle "
                f"within {first.config['duration']:g} s under a push.",
                [
                    "joint",
                    "gravity, cad_closed",
                    "largest difference",
                    "peak, cad_closed",
                    "peak, uniform_density",
                    "limit",
                ],
                torque_rows,
                tuple(range(1, 6)),
                origin(second),
            ),
            Notice(
                "finding",
                "Dynamics of this arm are known to a third, its admittance does not depend on it",
                f"Of the links above {1e3 * _LIGHT:g} g the sets differ most in {worst}, by "
                f"{100.0 * _larger(pairs[worst]):.0f} %; gravity torques differ by up to "
                f"{quantity(100.0 * float(share.max()), '%', 2)} of a joint's largest. The tip's motion under "
                "admittance control differs by "
                f"{quantity(float(apart(first, second, 'tip').max()), 'm', 2)} at most: a position-controlled arm does "
                "not ask for masses. What is said of torques in this report holds to that uncertainty.",
            ),
        ),
    )


def _masses(run: Run) -> dict[str, float]:
    """Return the mass of each link of a run's URDF, in kg."""
    links = ET.fromstring(run.urdf).iter("link")  # noqa: S314 - our own text
    found = {str(link.get("name")): link.find("inertial/mass") for link in links}
    return {name: float(mass.get("value", "0")) for name, mass in found.items() if mass is not None}


def _larger(pair: tuple[float, float]) -> float:
    """Return by what share the larger of two masses exceeds the smaller."""
    return max(pair) / min(pair) - 1.0


def _gravity(run: Run) -> FloatArray:
    """Return gravity torques at random postures, the same for every run, shape (count, nq), in N m."""
    model = model_of(run)
    low, high = np.clip(model.position_limits, -np.pi, np.pi)
    postures = np.random.default_rng(0).uniform(low, high, (_COUNT, joint_columns(run.trace, "q").shape[1]))
    return np.array([model.gravity_torque(q) for q in postures])
