"""How well the arm's masses are known, and what follows for its torques."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping

import numpy as np

from runner.reporting.document import FloatArray, Section, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import ROUNDING, Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import apart, median
from runner.store import Run
from runner.works.meca500.plan import INERTIALS

_COUNT = 1000
_LIGHT = 0.1  # kg and N m, below which a share means little


def inertials_section(runs: Mapping[str, Run]) -> Section:
    """Return the two sets of inertials side by side: masses, gravity torques over postures, torques of a motion."""
    first, second = (runs[f"inertials/{name}"] for name in INERTIALS)
    pairs = _moving(runs)
    worst = _most_different(runs)
    gravity = [_gravity(run) for run in (first, second)]
    pairs["all that move"] = (sum(pair[0] for pair in pairs.values()), sum(pair[1] for pair in pairs.values()))
    rows = [
        [link, number(a), number(b), number(max(a, b) / min(a, b)), INERTIALS[int(b > a)]]
        for link, (a, b) in pairs.items()
    ]
    torque_rows = [
        [
            f"joint {joint + 1}",
            number(float(np.abs(gravity[0][:, joint]).max()), rounding=ROUNDING),
            number(float(np.abs(gravity[1] - gravity[0])[:, joint].max()), rounding=ROUNDING),
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
                "The maker publishes no masses. There are two sets, chosen by robot.inertials: "
                "cad_closed, CAD values of an unofficial description closed to the arm's weight, and uniform_density, "
                "the volumes of the maker's meshes times one density. The controller's own rigid-body model is that "
                "of the arm simulated, so that here only what the arm needs changes."
            ),
            Table(
                "Masses of the moving links, in kg, the ratio of the larger to the smaller, and which one is larger.",
                ["link", *INERTIALS, "ratio", "larger in"],
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
            inertials_finding(worst, **inertials_values(runs)),
        ),
    )


def inertials_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on the two sets of inertials is about."""
    first, second = (runs[f"inertials/{name}"] for name in INERTIALS)
    pair = _moving(runs)[_most_different(runs)]
    gravity = [_gravity(run) for run in (first, second)]
    loaded = np.abs(gravity[0]).max(axis=0) > _LIGHT
    share = (np.abs(gravity[1] - gravity[0]).max(axis=0) / np.abs(gravity[0]).max(axis=0, initial=1e-12))[loaded]
    return {
        "light": Measured("mass below which links are left out", 1e3 * _LIGHT, "g"),
        "mass": Measured("largest difference of a link's masses", 100.0 * _larger(pair), "%"),
        "gravity": Measured(
            "largest difference of gravity torques over the joint's largest", 100.0 * float(share.max()), "%"
        ),
        "tip": Measured("largest distance of the tips", float(apart(first, second, "tip").max()), "m"),
    }


def inertials_finding(link: str, light: Measured, mass: Measured, gravity: Measured, tip: Measured) -> Finding:
    """Return what the two sets of inertials leave unknown.

    Args:
        link: Which link's masses differ most.
        light: The mass below which links are left out.
        mass: By how much the larger mass of that link exceeds the smaller.
        gravity: By how much gravity torques differ.
        tip: How far the tips are apart under admittance control.
    """
    return finding(
        "The torques of this arm are known no better than its masses; its admittance hardly depends on them",
        f"Of the links above {light} the sets differ most in {link}, where the larger mass exceeds the smaller by "
        f"{mass}; gravity torques differ by up to {gravity} of a joint's largest. The tip's motion under admittance "
        f"control differs by {tip} at most. All torques in this report have that uncertainty.",
        mass > 20.0,
        mass < 50.0,
        gravity < 30.0,
        tip < 1e-4,
    )


def _moving(runs: Mapping[str, Run]) -> dict[str, tuple[float, float]]:
    """Return both masses of each link that moves, by its name, in kg."""
    first, second = (_masses(runs[f"inertials/{name}"]) for name in INERTIALS)
    return {link: (first[link], second[link]) for link in first if link.startswith("link")}


def _most_different(runs: Mapping[str, Run]) -> str:
    pairs = _moving(runs)
    return max((link for link in pairs if max(pairs[link]) > _LIGHT), key=lambda link: _larger(pairs[link]))


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
