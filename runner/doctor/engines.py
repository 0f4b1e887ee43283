"""Comparison of PyBullet and MuJoCo with Pinocchio on the same arm."""

import numpy as np

from runner.base.engines import has_pybullet
from runner.base.errors import ConfigError
from runner.doctor.finding import DoctorFinding
from runner.plants.agreement import ENGINES, compare
from runner.robots.model import RobotModel

_SAMPLES = 20


def compare_engines(urdf: str, model: RobotModel, generator: np.random.Generator) -> list[DoctorFinding]:
    """Compare the motion of PyBullet and MuJoCo with that of Pinocchio; see compare.

    If PyBullet is not installed, a note says so.
    """
    there = {kind: name for kind, name in ENGINES.items() if kind != "bullet" or has_pybullet()}
    missing = [] if "bullet" in there else [DoctorFinding("note", "engines", "PyBullet is not installed: not compared")]
    return missing + [_compare(kind, name, urdf, model, generator) for kind, name in there.items()]


def _compare(kind: str, name: str, urdf: str, model: RobotModel, generator: np.random.Generator) -> DoctorFinding:
    try:
        off, difference = compare(kind, urdf, model, _SAMPLES, generator)
    except ConfigError as error:
        return DoctorFinding("refused", "engines", "; ".join(p.removeprefix("robot.urdf: ") for p in error.problems))
    states = f"at {_SAMPLES} random states to {off:.1e} of the largest torque"
    if not difference:
        return DoctorFinding(
            "note", "engines", f"{name} and Pinocchio move it alike, {states}, and stop it at its limits"
        )
    return DoctorFinding("refused", "engines", f"{name} and Pinocchio move it differently, {states}: {difference}")
