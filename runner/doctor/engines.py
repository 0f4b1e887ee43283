"""Comparison of PyBullet and MuJoCo with Pinocchio on the same arm."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.engines import has_pybullet
from runner.base.errors import ConfigError
from runner.doctor.finding import Finding
from runner.plants.mujoco import Mujoco
from runner.robots.model import RobotModel

if TYPE_CHECKING:
    from runner.plants.bullet import Bullet

_SAMPLES = 100
_STEP = 1e-4  # s
_AGREE = 1e-6  # of the largest torque: beyond it the engines simulate different arms
_LEAST = 1e-12  # kg and kg m^2, of MuJoCo's moving links, as in conf/plant/mujoco.yaml


def compare_engines(urdf: str, model: RobotModel, generator: np.random.Generator) -> list[Finding]:
    """Return the distance of PyBullet's and MuJoCo's motion from Pinocchio's, at random states within joint limits.

    It is that of one step of theirs, under random torques, as the torques that would make up for it. Where PyBullet is
    not installed a note says so.
    """
    mujoco = _compare("MuJoCo", lambda: Mujoco(urdf, model, _STEP, 1, "euler", _LEAST), model, generator)
    if not has_pybullet():
        return [Finding("note", "engines", "PyBullet is not installed: not compared with Pinocchio"), mujoco]
    from runner.plants.bullet import Bullet

    return [_compare("PyBullet", lambda: Bullet(urdf, model, _STEP, 1), model, generator), mujoco]


def _compare(
    name: str, make: "Callable[[], Bullet | Mujoco]", model: RobotModel, generator: np.random.Generator
) -> Finding:
    try:
        plant = make()
    except ConfigError as error:
        return Finding("refused", "engines", "; ".join(p.removeprefix("robot.urdf: ") for p in error.problems))
    try:
        off = max(_off(plant, model, generator) for _ in range(_SAMPLES))
    finally:
        plant.close()
    text = f"{name} and Pinocchio move it alike: at {_SAMPLES} random states to {off:.1e} of the largest torque"
    if off < _AGREE:
        return Finding("note", "engines", text)
    text = (
        f"{name} and Pinocchio move it differently: at {_SAMPLES} random states up to {off:.1e} of the largest torque"
    )
    return Finding("refused", "engines", text, "look at the links above: all engines must read the same arm")


def _off(plant: "Bullet | Mujoco", model: RobotModel, generator: np.random.Generator) -> float:
    """Return the torque missing in an engine's step from a random state, as a fraction of the largest one."""
    lower, upper = model.usual_range
    q = 0.5 * (lower + upper) + 0.45 * (upper - lower) * generator.uniform(-1.0, 1.0, model.nq)  # away from the stops
    dq, asked = generator.uniform(-1.0, 1.0, (2, model.nq))
    M: FloatArray = model.mass_matrix(q)
    tau = model.gravity_torque(q) + model.coriolis_torque(q, dq) + M @ asked
    plant.reset(q, dq)
    plant.advance(tau)
    return float(np.abs(M @ ((plant.dq - dq) / _STEP - asked)).max() / np.abs(tau).max())
